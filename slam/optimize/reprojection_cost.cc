#include "slam/optimize/reprojection_cost.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/geometry/rotation.h"

namespace planecast::slam {
namespace {

using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;
using ConstVector3 = Eigen::Map<const Eigen::Vector3d>;
using Row7 = Eigen::Matrix<double, 1, 7>;
using Row3 = Eigen::Matrix<double, 1, 3>;

}  // namespace

PoseBlock block_from_pose(const Pose& cam_from_world) {
  PoseBlock block;
  Eigen::Map<Eigen::Quaterniond>(block.data()) =
      Eigen::Quaterniond(cam_from_world.linear()).normalized();
  Eigen::Map<Eigen::Vector3d>(block.data() + 4) = cam_from_world.translation();
  return block;
}

Pose pose_from_block(const PoseBlock& block) {
  Pose pose = Pose::Identity();
  pose.linear() = ConstQuaternion(block.data()).toRotationMatrix();
  pose.translation() = ConstVector3(block.data() + 4);
  return pose;
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond turn = rotation_exp(ConstVector3(delta));
  Eigen::Map<Eigen::Quaterniond>{x_plus_delta} = (turn * ConstQuaternion(x)).normalized();
  Eigen::Map<Eigen::Vector3d>(x_plus_delta + 4) =
      turn * ConstVector3(x + 4) + ConstVector3(delta + 3);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Eigen::Quaterniond turn = ConstQuaternion(y) * ConstQuaternion(x).conjugate();
  const Eigen::AngleAxisd angle_axis(turn);
  Eigen::Map<Eigen::Vector3d>{y_minus_x} = angle_axis.angle() * angle_axis.axis();
  Eigen::Map<Eigen::Vector3d>(y_minus_x + 3) = ConstVector3(y + 4) - turn * ConstVector3(x + 4);
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

ReprojectionTerm::ReprojectionTerm(const Camera& camera, double depth_baseline_m,
                                   const Eigen::Vector2d& pixel, double sigma_px, double depth)
    : pixel(pixel),
      inverse_sigma(1.0 / sigma_px),
      inverse_depth(depth > 0.0 ? 1.0 / depth : 0.0),
      fx(camera.fx),
      fy(camera.fy),
      cx(camera.cx),
      cy(camera.cy),
      baseline_fx(depth_baseline_m * std::abs(camera.fx)) {}

bool ReprojectionTerm::evaluate(const double* pose, const double* point, double focal,
                                double* residuals, double* by_pose, double* by_point,
                                double* by_focal) const {
  const Eigen::Matrix3d rotation = ConstQuaternion(pose).toRotationMatrix();
  const Eigen::Vector3d p = rotation * ConstVector3(point) + ConstVector3(pose + 4);
  const int count = rows();
  if (!(p.z() > 0.0)) return false;
  const double inverse_z = 1.0 / p.z();
  const double x = p.x() * inverse_z;
  const double y = p.y() * inverse_z;
  residuals[0] = inverse_sigma * (focal * fx * x + cx - pixel.x());
  residuals[1] = inverse_sigma * (focal * fy * y + cy - pixel.y());
  if (count == 3) residuals[2] = inverse_sigma * baseline_fx * (inverse_z - inverse_depth);

  const double u_by_x = inverse_sigma * focal * fx * inverse_z;
  const double v_by_y = inverse_sigma * focal * fy * inverse_z;
  const Eigen::Vector3d by_point_cam[3] = {
      {u_by_x, 0.0, -u_by_x * x},
      {0.0, v_by_y, -v_by_y * y},
      {0.0, 0.0, -inverse_sigma * baseline_fx * inverse_z * inverse_z}};
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d& gradient = by_point_cam[i];
    if (by_pose != nullptr) {
      Eigen::Map<Row7>{by_pose + 7 * i} << p.cross(gradient).transpose(), gradient.transpose(), 0.0;
    }
    if (by_point != nullptr) {
      Eigen::Map<Row3>{by_point + 3 * i}.noalias() = gradient.transpose() * rotation;
    }
  }
  if (by_focal != nullptr) {
    by_focal[0] = inverse_sigma * fx * x;
    by_focal[1] = inverse_sigma * fy * y;
    if (count == 3) by_focal[2] = 0.0;
  }
  return true;
}

double ReprojectionTerm::chi2(const Eigen::Vector3d& point_cam, double focal) const {
  if (!(point_cam.z() > 0.0)) return std::numeric_limits<double>::infinity();
  double squared = squared_error_px(point_cam, focal);
  if (inverse_depth > 0.0) {
    const double disparity = baseline_fx * (1.0 / point_cam.z() - inverse_depth);
    squared += disparity * disparity;
  }
  return inverse_sigma * inverse_sigma * squared;
}

bool PointPlaneCost::Evaluate(double const* const* parameters, double* residuals,
                              double** jacobians) const {
  const ConstVector3 point(parameters[0]);
  const ConstVector3 normal(parameters[1]);
  residuals[0] = inverse_sigma_ * (normal.dot(point) + parameters[2][0]);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) Eigen::Map<Eigen::Vector3d>{jacobians[0]} = inverse_sigma_ * normal;
  if (jacobians[1] != nullptr) Eigen::Map<Eigen::Vector3d>{jacobians[1]} = inverse_sigma_ * point;
  if (jacobians[2] != nullptr) jacobians[2][0] = inverse_sigma_;
  return true;
}

bool CentreDistanceCost::Evaluate(double const* const* parameters, double* residuals,
                                  double** jacobians) const {
  const Eigen::Matrix3d rotation = ConstQuaternion(parameters[0]).toRotationMatrix();
  const Eigen::Vector3d from_anchor =
      -(rotation.transpose() * ConstVector3(parameters[0] + 4)) - anchor_;
  const double distance = from_anchor.norm();
  residuals[0] = inverse_sigma_ * (distance - distance_);
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  // A step (omega, v) moves the centre by -R^T v, whatever omega.
  Eigen::Map<Row7> by_pose(jacobians[0]);
  by_pose.setZero();
  if (distance > 0.0) {
    by_pose.segment<3>(3) = -inverse_sigma_ / distance * (rotation * from_anchor).transpose();
  }
  return true;
}

}  // namespace planecast::slam
