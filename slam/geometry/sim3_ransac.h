#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/geometry/sim3.h"

namespace planecast::slam {

/// One point as two cameras know it: in each camera's frame and units, and where each saw it.
struct SimilarityPair {
  Eigen::Vector3d point_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d point_b = Eigen::Vector3d::Zero();
  Eigen::Vector2d pixel_a = Eigen::Vector2d::Zero();  ///< undistorted
  Eigen::Vector2d pixel_b = Eigen::Vector2d::Zero();
  double sigma_a_px = 1.0;
  double sigma_b_px = 1.0;
};

struct SimilarityOptions {
  bool with_scale = true;  ///< false: SE3
  int iterations = 300;
  double chi2 = 9.21;    ///< of each of the two reprojections, 99 % [K]
  int min_inliers = 20;  ///< [K]
  std::uint64_t seed = 1;
};

struct SimilarityResult {
  Similarity a_from_b;
  std::vector<char> inlier;  ///< per pair
  int num_inliers = 0;
};

/// Whether both reprojections, of b's point in a and of a's in b, lie within `chi2`.
bool agrees(const Camera& camera, const SimilarityPair& pair, const Similarity& a_from_b,
            double chi2);

/// RANSAC over Umeyama's alignment of three points, judged by reprojection both ways; seeded, ends
/// early at 99.9 % confidence. Nothing with fewer inliers than asked for, of which 3 are the least.
std::optional<SimilarityResult> solve_similarity(const Camera& camera,
                                                 const std::vector<SimilarityPair>& pairs,
                                                 const SimilarityOptions& options);

}  // namespace planecast::slam
