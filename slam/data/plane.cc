#include "slam/data/plane.h"

#include <Eigen/Geometry>

namespace planecast::slam {

namespace {

/// Nearest unit vector to `axis` that is orthogonal to `normal`.
Eigen::Vector3d in_plane(const Eigen::Vector3d& axis, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d projected = axis - axis.dot(normal) * normal;
  return projected.norm() > 1e-9 ? projected.normalized() : normal.unitOrthogonal();
}

}  // namespace

Pose Plane::world_from_plane() const {
  Pose pose = Pose::Identity();
  pose.linear().col(0) = x_axis;
  pose.linear().col(1) = normal.cross(x_axis);
  pose.linear().col(2) = normal;
  pose.translation() = origin;
  return pose;
}

void Plane::refit(const Eigen::Vector3d& new_normal, double new_offset) {
  const auto turn = Eigen::Quaterniond::FromTwoVectors(normal, new_normal);
  normal = new_normal;
  offset = new_offset;
  x_axis = in_plane(turn * x_axis, normal);
  origin -= signed_distance(origin) * normal;
}

}  // namespace planecast::slam
