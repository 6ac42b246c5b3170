#pragma once

#include <Eigen/Core>

#include "slam/data/camera.h"

namespace planecast::slam {

/// Raw pixel of a point in the camera frame. Domain: z > 0.
inline Eigen::Vector2d project_raw(const Camera& camera, const Eigen::Vector3d& point_cam) {
  const Eigen::Vector2d pixel = camera.project(point_cam);
  return camera.has_distortion() ? camera.distort(pixel) : pixel;
}

/// Derivative of the raw pixel by the undistorted one, by central differences of one pixel: the
/// distortion changes slowly over an image. The identity for a lens without distortion.
inline Eigen::Matrix2d raw_by_undistorted(const Camera& camera, const Eigen::Vector2d& pixel) {
  if (!camera.has_distortion()) return Eigen::Matrix2d::Identity();
  const Eigen::Vector2d x(0.5, 0.0);
  const Eigen::Vector2d y(0.0, 0.5);
  Eigen::Matrix2d jacobian;
  jacobian.col(0) = camera.distort(pixel + x) - camera.distort(pixel - x);
  jacobian.col(1) = camera.distort(pixel + y) - camera.distort(pixel - y);
  return jacobian;
}

/// Derivative of the undistorted pixel by the point in the camera frame.
inline Eigen::Matrix<double, 2, 3> pixel_by_point(const Camera& camera,
                                                  const Eigen::Vector3d& point_cam) {
  const double inverse_z = 1.0 / point_cam.z();
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << camera.fx * inverse_z, 0.0, -camera.fx * point_cam.x() * inverse_z * inverse_z,  //
      0.0, camera.fy * inverse_z, -camera.fy * point_cam.y() * inverse_z * inverse_z;
  return jacobian;
}

}  // namespace planecast::slam
