#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"
#include "slam/geometry/random.h"

/// Points, poses and noisy pixels with known truth, for the tests of geometry and optimisation.
namespace planecast::slam::synthetic {

/// A seed of the test's own, so that tests do not depend on their order (FNV-1a).
inline std::uint64_t seed_of(const std::string& name) {
  std::uint64_t hash = 1469598103934665603ULL;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

inline Camera camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525.0;
  camera.fy = 520.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

inline double gaussian(Random& random) {
  const double u = 1.0 - random.uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * M_PI * random.uniform());
}

inline Eigen::Vector3d gaussian3(Random& random) {
  const double x = gaussian(random), y = gaussian(random), z = gaussian(random);
  return {x, y, z};
}

inline Eigen::Vector2d noisy(const Eigen::Vector2d& pixel, double sigma_px, Random& random) {
  const double x = gaussian(random), y = gaussian(random);
  return pixel + sigma_px * Eigen::Vector2d(x, y);
}

inline Eigen::Vector2d random_pixel(const Camera& camera, Random& random) {
  const double u = random.uniform(), v = random.uniform();
  return {u * (camera.width - 1), v * (camera.height - 1)};
}

/// cam_from_world of a camera at `centre`, turned by `turn` (rotation vector) against the world.
inline Pose pose_at(const Eigen::Vector3d& centre, const Eigen::Vector3d& turn) {
  Pose world_from_cam = Pose::Identity();
  world_from_cam.translation() = centre;
  if (turn.norm() > 0.0) {
    world_from_cam.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  return world_from_cam.inverse();
}

/// Points in a box in front of the origin: x in +-2, y in +-1.5, z in 3..7.
inline std::vector<Eigen::Vector3d> box_points(int count, Random& random) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    points.emplace_back(4.0 * x - 2.0, 3.0 * y - 1.5, 3.0 + 4.0 * z);
  }
  return points;
}

inline double degrees(double radians) { return radians * 180.0 / M_PI; }

inline double rotation_error_deg(const Pose& a, const Pose& b) {
  const Eigen::Matrix3d difference = a.linear().transpose() * b.linear();
  return degrees(Eigen::AngleAxisd(difference).angle());
}

inline double direction_error_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees(std::atan2(a.cross(b).norm(), a.dot(b)));
}

}  // namespace planecast::slam::synthetic
