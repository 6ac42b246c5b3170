#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "slam/fitting/plane_model.h"
#include "slam/geometry/two_view.h"

namespace planecast::bench {

/// How the mask that gathered the data points differs from the true instance. `share` is that of
/// the group's points: eroded away, leaked in from what adjoins, or of the second instance merged
/// in; a split mask holds 1 - share of the instance.
enum class Corruption { kNone, kErosion, kLeakage, kMerged, kSplit };

struct Mask {
  Corruption kind = Corruption::kNone;
  double share = 0.0;
};
std::string name_of(const Mask& mask);

/// Matches of two images 640 x 480 with exact truth. Inliers have Gaussian noise of `noise_px` on
/// both ends. Of the rest one part is gross (uniform over the second image), and what a mask leaked
/// in follows the homography of the adjoining surface.
struct HomographyWorld {
  std::vector<slam::PointPair> pairs;
  std::vector<float> quality;  ///< 0..1, better for inliers on average, as descriptor distances are
  std::vector<char> inlier;
  Eigen::Matrix3d cur_H_ref = Eigen::Matrix3d::Identity();
  std::vector<Eigen::Vector2d> region;  ///< a grid over the instance, where errors are measured
};
HomographyWorld make_homography_world(int points, double noise_px, double outliers,
                                      const Mask& mask, std::uint64_t seed);

/// Landmarks of one mask: a plane patch of 1 m x 1 m seen from 2 m, with Gaussian noise of
/// `noise_m`, a share `outliers` of gross ones around it, and by the mask's corruption part of a
/// surface that adjoins (upright at the mask's border, or a step of 8 cm where merged).
struct PlaneWorld {
  slam::PlanePoints points;
  std::vector<char> inlier;
  slam::PlaneEquation plane;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
};
PlaneWorld make_plane_world(int points, double noise_m, double outliers, const Mask& mask,
                            std::uint64_t seed);

}  // namespace planecast::bench
