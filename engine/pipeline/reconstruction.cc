#include "engine/pipeline/reconstruction.h"

#include <Eigen/Geometry>

namespace planecast::engine {

slam::Pose PlaneRecord::world_from_plane() const {
  // x_axis is in the plane but for rounding; orthogonalising keeps the pose rigid whatever was
  // read.
  Eigen::Vector3d x = x_axis - normal.dot(x_axis) * normal;
  x = x.norm() > 1e-9 ? x.normalized() : normal.unitOrthogonal();
  slam::Pose pose = slam::Pose::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = normal.cross(x);
  pose.linear().col(2) = normal;
  pose.translation() = origin;
  return pose;
}

}  // namespace planecast::engine
