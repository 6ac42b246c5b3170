#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// A camera that is turned about the map: the world's up stays up.
class MapCamera {
 public:
  /// Looks at the camera's path and the points (wild ones left out) from behind and above.
  explicit MapCamera(const Reconstruction& reconstruction);

  void turn(double yaw_rad, double pitch_rad);
  /// Factors below 1 come nearer.
  void zoom(double factor);
  /// Shifts the view by a part of the picture's height.
  void shift(double right, double down);

  struct Projected {
    Eigen::Vector2d at;  ///< in units of the picture's height, from its middle, y down
    double depth = 0.0;
  };
  /// Nothing behind the near plane.
  std::optional<Projected> project(const Eigen::Vector3d& world) const;

  double radius() const { return radius_; }  ///< of what matters
  double distance() const { return distance_; }
  slam::Pose world_from_camera() const;

 private:
  void update();

  Eigen::Matrix3d world_from_level_;  ///< columns right, ahead, up
  Eigen::Vector3d target_ = Eigen::Vector3d::Zero();
  double radius_ = 1.0;
  double yaw_rad_ = -0.5;
  double pitch_rad_ = 0.6;  ///< of the view below the horizon
  double distance_ = 3.0;
  slam::Pose camera_from_world_ = slam::Pose::Identity();
};

}  // namespace planecast::engine
