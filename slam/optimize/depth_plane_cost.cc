#include "slam/optimize/depth_plane_cost.h"

#include <Eigen/Geometry>

namespace planecast::slam {

bool DepthPlaneCost::Evaluate(double const* const* parameters, double* residuals,
                              double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> cam_from_world(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> normal(parameters[1]);
  const Eigen::Vector3d point_world = cam_from_world.conjugate() * (point_cam_ - translation);
  residuals[0] = inverse_sigma_ * (normal.dot(point_world) + parameters[2][0]);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    // A step (omega, v) of the pose moves the world point by R^T (p x omega - v).
    const Eigen::Vector3d normal_cam = cam_from_world * normal;
    Eigen::Map<Eigen::Matrix<double, 1, 7>> by_pose(jacobians[0]);
    by_pose << inverse_sigma_ * normal_cam.cross(point_cam_).transpose(),
        -inverse_sigma_ * normal_cam.transpose(), 0.0;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Vector3d>{jacobians[1]} = inverse_sigma_ * point_world;
  }
  if (jacobians[2] != nullptr) jacobians[2][0] = inverse_sigma_;
  return true;
}

}  // namespace planecast::slam
