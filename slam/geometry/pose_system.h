#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "slam/data/types.h"
#include "slam/geometry/rotation.h"

namespace planecast::slam {

/// A step of a pose: rotation vector, then translation, applied on the left,
/// cam_from_world' = (exp(omega), v) cam_from_world. A point p in the camera moves by omega x p +
/// v.
using PoseStep = Eigen::Matrix<double, 6, 1>;

/// The pose after a step; the rotation is kept orthonormal.
inline Pose stepped(const Pose& cam_from_world, const PoseStep& step) {
  const Eigen::Quaterniond turn = rotation_exp(step.head<3>());
  Pose pose = Pose::Identity();
  pose.linear() =
      (turn * Eigen::Quaterniond(cam_from_world.linear())).normalized().toRotationMatrix();
  pose.translation() = turn * cam_from_world.translation() + step.tail<3>();
  return pose;
}

/// Normal equations of one pose, for residuals that are functions of points in the camera frame.
struct PoseSystem {
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
  PoseStep gradient = PoseStep::Zero();
  double cost = 0.0;  ///< left to the caller

  /// Derivative of a residual by the step, from its gradient by the point.
  static PoseStep jacobian(const Eigen::Vector3d& point_cam, const Eigen::Vector3d& by_point) {
    PoseStep row;
    row << point_cam.cross(by_point), by_point;
    return row;
  }
  void add(const Eigen::Vector3d& point_cam, const Eigen::Vector3d& by_point, double residual,
           double weight) {
    const PoseStep row = jacobian(point_cam, by_point);
    hessian.noalias() += (weight * row) * row.transpose();
    gradient.noalias() += (weight * residual) * row;
  }
  /// Levenberg-Marquardt step with the diagonal raised by the share `damping`. May be non-finite
  /// where the observations leave the pose open.
  PoseStep solve(double damping) const {
    Eigen::Matrix<double, 6, 6> damped = hessian;
    damped.diagonal() *= 1.0 + damping;
    return -damped.ldlt().solve(gradient);
  }
};

}  // namespace planecast::slam
