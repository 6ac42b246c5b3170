#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// Linear (DLT, SVD) triangulation of a point from two undistorted pixels. Returns nothing for a point
/// at infinity or behind either camera.
std::optional<Eigen::Vector3d> triangulate(const Camera& camera, const Pose& a_from_world,
                                           const Eigen::Vector2d& pixel_a, const Pose& b_from_world,
                                           const Eigen::Vector2d& pixel_b);

/// Cosine of the angle at which two cameras see a world point.
double parallax_cosine(const Pose& a_from_world, const Pose& b_from_world,
                       const Eigen::Vector3d& point_world);

/// b_F_a with x_b^T F x_a = 0 in undistorted pixels.
Eigen::Matrix3d fundamental_from_poses(const Camera& camera, const Pose& a_from_world,
                                       const Pose& b_from_world);

}  // namespace planecast::slam
