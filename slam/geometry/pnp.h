#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

struct PnpOptions {
  int iterations = 300;
  double threshold_px = 4.0;  ///< times the observation's sigma
  int min_inliers = 10;
  std::uint64_t seed = 1;
};

struct PnpResult {
  Pose cam_from_world = Pose::Identity();
  std::vector<char> inlier;
  int num_inliers = 0;
};

/// RANSAC (MSAC) over the minimal solver AP3P (Ke, Roumeliotis, CVPR 2017), every new best refined
/// by Gauss-Newton on its inliers; seeded. Ends early at 99.9 % confidence. `sigma_px` is per pair.
/// Returns nothing with fewer inliers than asked for, of which 4 are the least.
std::optional<PnpResult> solve_pnp(const Camera& camera,
                                   const std::vector<Eigen::Vector3d>& points_world,
                                   const std::vector<Eigen::Vector2d>& pixels,
                                   const std::vector<double>& sigma_px, const PnpOptions& options);

}  // namespace planecast::slam
