#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slam/geometry/two_view.h"

namespace planecast::slam {

/// Lengths are pixels of an image 640 wide and are scaled with image_width / 640.
struct HomographyOptions {
  int image_width = 640;
  int image_height = 480;
  double threshold_px = 2.0;  ///< symmetric transfer error of an inlier [P]
  /// eps_L: accepted RMS of the inliers' errors [D]. Chance matches fill the threshold's disc and
  /// have 1.41; keypoint noise of 1 px, cut off at the threshold, has 1.29, of 0.5 px 0.93.
  double max_rms_px = 1.3;
  double lambda = 0.975;  ///< spatial coherence [P]
  int min_inliers = 12;
  double min_inlier_ratio = 0.1;
  bool graph_cut = true;   ///< false: plain RANSAC, for the ablation
  bool all_pairs = false;  ///< the paper's neighbourhood: all pairs of a cell
  std::uint64_t seed = 1;
};

struct HomographyFit {
  Eigen::Matrix3d cur_H_ref = Eigen::Matrix3d::Identity();  ///< H(2,2) = 1 where it is not 0
  std::vector<char> inlier;                                 ///< per pair
  int num_inliers = 0;
  double rms_px = 0.0;  ///< of the inliers' symmetric transfer errors
  int label = 0;        ///< plane instance it was fitted to; 0: to all pairs
  int samples = 0;
  int rounds = 0;
  int cuts = 0;
};

/// Homography by sequential graph-cut RANSAC: one fit per plane instance, or over all pairs where
/// there are no labels or none of the instances gives one; the one with the most inliers, counted
/// over all pairs, is returned [P]. `quality`, lower is better (descriptor distance), orders the
/// sampling and may be empty; so may `labels` (0 = none). Nothing where no fit is accepted.
/// Repeatable for a seed.
std::optional<HomographyFit> fit_homography(const std::vector<PointPair>& pairs,
                                            const std::vector<float>& quality,
                                            const std::vector<int>& labels,
                                            const HomographyOptions& options);

}  // namespace planecast::slam
