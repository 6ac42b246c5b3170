#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// Matched undistorted pixels of a reference and a current image.
struct PointPair {
  Eigen::Vector2d ref;
  Eigen::Vector2d cur;
};

struct FundamentalOptions {
  int iterations = 200;
  double sigma_px = 1.0;  ///< of a keypoint, [K]
  std::uint64_t seed = 1;
};

struct FundamentalResult {
  Eigen::Matrix3d cur_F_ref;  ///< x_cur^T F x_ref = 0
  std::vector<char> inlier;
  double score = 0.0;  ///< S_F: sum of (5.991 - chi2) over both directions, gated at 3.841
};

/// Normalised 8-point RANSAC; needs at least 8 pairs. The score is ORB-SLAM's S_F (Mur-Artal 2015,
/// section IV).
std::optional<FundamentalResult> find_fundamental(const std::vector<PointPair>& pairs,
                                                  const FundamentalOptions& options);

/// ORB-SLAM's S_H of a homography: sum over both directions of (5.991 - chi2) where chi2 < 5.991.
double score_homography(const Eigen::Matrix3d& cur_H_ref, const std::vector<PointPair>& pairs,
                        double sigma_px, std::vector<char>* inlier);

/// Candidate relative poses cur_from_ref, |t| = 1: four, or none for a singular matrix or a
/// rotation.
std::vector<Pose> decompose_homography(const Eigen::Matrix3d& cur_H_ref, const Camera& camera);
std::vector<Pose> decompose_fundamental(const Eigen::Matrix3d& cur_F_ref, const Camera& camera);

struct TwoViewOptions {
  double min_parallax_deg = 1.0;  ///< of the 50th largest and of the median position
  double max_runner_up_ratio =
      0.75;  ///< the second best pose has fewer good points than this share
  /// Of the inliers, that the best pose must explain; ORB-SLAM asks for 0.9, less lets a guessed
  /// focal length pass.
  double min_good_ratio = 0.75;
  int min_points = 50;
  double sigma_px = 1.0;
};

enum class TwoViewFailure { kNone, kTooFewMatches, kTooLittleParallax, kAmbiguous, kTooFewPoints };

struct TwoViewResult {
  TwoViewFailure failure = TwoViewFailure::kNone;
  Pose cur_from_ref = Pose::Identity();
  std::vector<std::optional<Eigen::Vector3d>> points_ref;  ///< per pair, in the reference camera
  double parallax_deg = 0.0;         ///< of the 50th largest (or the smallest, if fewer)
  double median_parallax_deg = 0.0;  ///< of the points that have a position
  int good = 0;                      ///< inliers that the pose explains, far ones among them
  int runner_up_good = 0;            ///< the same of the second best candidate
};

/// Chooses among candidate poses by positive depth, reprojection error (chi2 5.991) and parallax,
/// and refines the chosen one on the Sampson distance of its points. A point seen under less than
/// 0.36 degrees counts as far: it is no witness of depth and gets no position. On failure the rest
/// of the result is what the best candidate gave.
TwoViewResult select_relative_pose(const std::vector<Pose>& candidates,
                                   const std::vector<PointPair>& pairs,
                                   const std::vector<char>& inlier, const Camera& camera,
                                   const TwoViewOptions& options);

}  // namespace planecast::slam
