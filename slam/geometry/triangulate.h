#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// Triangulation of a point from two undistorted pixels: the pixels are moved onto epipolar lines
/// of each other by the least squared distance (see intersect_rays), where the rays meet. Returns
/// nothing for a point at infinity or behind either camera.
std::optional<Eigen::Vector3d> triangulate(const Camera& camera, const Pose& a_from_world,
                                           const Eigen::Vector2d& pixel_a, const Pose& b_from_world,
                                           const Eigen::Vector2d& pixel_b);

/// The same with the relative pose at hand; the point is in the frame of a and its depth in either
/// camera may be negative, as it comes out for noisy pixels of a far point. Rays are (x, y, 1),
/// `b_E_a` is the pair's essential matrix. The correction is "niter2" of Lindstrom, Triangulation
/// Made Easy (CVPR 2010): two steps, optimal to within rounding where fx = fy. Returns nothing for
/// parallel rays.
std::optional<Eigen::Vector3d> intersect_rays(const Pose& b_from_a, const Eigen::Matrix3d& b_E_a,
                                              const Eigen::Vector3d& ray_a,
                                              const Eigen::Vector3d& ray_b);

/// Cosine of the angle at which two cameras see a world point.
double parallax_cosine(const Pose& a_from_world, const Pose& b_from_world,
                       const Eigen::Vector3d& point_world);

/// [t]_x R: x_b^T E x_a = 0 for rays of the same point.
Eigen::Matrix3d essential_from_pose(const Pose& b_from_a);

/// b_F_a with x_b^T F x_a = 0 in undistorted pixels.
Eigen::Matrix3d fundamental_from_poses(const Camera& camera, const Pose& a_from_world,
                                       const Pose& b_from_world);

/// Calibration matrix K of the ideal pinhole.
Eigen::Matrix3d calibration_matrix(const Camera& camera);

/// [v]_x: skew(v) * w = v x w.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0)
      .finished();
}

}  // namespace planecast::slam
