#include "engine/inspect/map_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/evaluate/statistics.h"

namespace planecast::engine {
namespace {

constexpr double kFocal = 1.2;  ///< over the picture's height: about 45 degrees
constexpr double kSteepest = 0.499 * std::numbers::pi;
constexpr double kFirstDistance = 2.1;  ///< radii
constexpr double kNearShare = 0.01;     ///< near plane, of the radius
constexpr double kWild = 0.03;          ///< of the points lie out at either end

/// Columns right, ahead (the mean viewing direction without its rise), up.
Eigen::Matrix3d level_axes(const Reconstruction& reconstruction) {
  const Eigen::Vector3d up = reconstruction.up.normalized();
  Eigen::Vector3d ahead = Eigen::Vector3d::Zero();
  for (const FrameRecord& frame : reconstruction.frames) {
    if (frame.world_from_cam) ahead += frame.world_from_cam->linear().col(2);
  }
  ahead -= ahead.dot(up) * up;
  ahead = ahead.norm() > 1e-6 ? Eigen::Vector3d(ahead.normalized()) : up.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << ahead.cross(up), ahead, up;
  return axes;
}

/// Of the camera's path, and of the points but for the wild ones.
Eigen::AlignedBox3d extent_of(const Reconstruction& reconstruction) {
  Eigen::AlignedBox3d box;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (frame.world_from_cam) box.extend(frame.world_from_cam->translation());
  }
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (!reconstruction.points.empty()) break;
    for (const Eigen::Vector3d& corner : plane.polygon) box.extend(corner);
  }
  if (reconstruction.points.empty()) return box;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const MapPoint& point : reconstruction.points) values.push_back(point.position[axis]);
    std::ranges::sort(values);
    low[axis] = percentile_of_sorted(values, kWild);
    high[axis] = percentile_of_sorted(values, 1.0 - kWild);
  }
  return box.extend(low).extend(high);
}

}  // namespace

MapCamera::MapCamera(const Reconstruction& reconstruction)
    : world_from_level_(level_axes(reconstruction)) {
  const Eigen::AlignedBox3d box = extent_of(reconstruction);
  if (!box.isEmpty()) {
    target_ = box.center();
    radius_ = std::max(0.5 * box.diagonal().norm(), 1e-6);
  }
  distance_ = kFirstDistance * radius_;
  update();
}

void MapCamera::turn(double yaw_rad, double pitch_rad) {
  yaw_rad_ += yaw_rad;
  pitch_rad_ = std::clamp(pitch_rad_ + pitch_rad, -kSteepest, kSteepest);
  update();
}

void MapCamera::zoom(double factor) {
  distance_ = std::clamp(distance_ * factor, 0.05 * radius_, 50.0 * radius_);
  update();
}

void MapCamera::shift(double right, double down) {
  const Eigen::Matrix3d axes = camera_from_world_.linear().transpose();
  target_ -= distance_ / kFocal * (right * axes.col(0) + down * axes.col(1));
  update();
}

std::optional<MapCamera::Projected> MapCamera::project(const Eigen::Vector3d& world) const {
  const Eigen::Vector3d p = camera_from_world_ * world;
  if (p.z() < kNearShare * radius_) return std::nullopt;
  return Projected{kFocal * p.head<2>() / p.z(), p.z()};
}

slam::Pose MapCamera::world_from_camera() const { return camera_from_world_.inverse(); }

void MapCamera::update() {
  const double level = std::cos(pitch_rad_);
  const Eigen::Vector3d view_level(std::sin(yaw_rad_) * level, std::cos(yaw_rad_) * level,
                                   -std::sin(pitch_rad_));
  const Eigen::Vector3d forward = world_from_level_ * view_level;
  const Eigen::Vector3d right = forward.cross(world_from_level_.col(2)).normalized();
  slam::Pose world_from_camera = slam::Pose::Identity();
  world_from_camera.linear() << right, forward.cross(right), forward;
  world_from_camera.translation() = target_ - distance_ * forward;
  camera_from_world_ = world_from_camera.inverse();
}

}  // namespace planecast::engine
