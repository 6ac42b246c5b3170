#include "slam/geometry/triangulate.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace planecast::slam {
namespace {

/// Squared sine of the angle between two rays below which they count as parallel (about 1e-7 rad, a
/// thousand times less than a keypoint can resolve).
constexpr double kParallelSineSquared = 1e-14;

struct RayPair {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
};

/// Lindstrom's niter2 with x = b, x' = a, so that b^T E a = 0 holds afterwards.
RayPair satisfy_epipolar(const Eigen::Matrix3d& b_E_a, const Eigen::Vector3d& ray_a,
                         const Eigen::Vector3d& ray_b) {
  const Eigen::Matrix2d e = b_E_a.topLeftCorner<2, 2>();
  Eigen::Vector2d n_b = (b_E_a * ray_a).head<2>();
  Eigen::Vector2d n_a = (b_E_a.transpose() * ray_b).head<2>();
  const double c = ray_b.dot(b_E_a * ray_a);
  const double a = n_b.dot(e * n_a);
  const double b = 0.5 * (n_b.squaredNorm() + n_a.squaredNorm());
  const double d = std::sqrt(std::max(0.0, b * b - a * c));
  if (b + d <= 0.0) return {ray_a, ray_b};
  double lambda = c / (b + d);
  const Eigen::Vector2d step_b = lambda * n_b;
  const Eigen::Vector2d step_a = lambda * n_a;
  n_b -= e * step_a;
  n_a -= e.transpose() * step_b;
  const double norm = n_b.squaredNorm() + n_a.squaredNorm();
  if (norm <= 0.0) return {ray_a, ray_b};
  lambda *= 2.0 * d / norm;
  RayPair moved{ray_a, ray_b};
  moved.b.head<2>() -= lambda * n_b;
  moved.a.head<2>() -= lambda * n_a;
  return moved;
}

}  // namespace

std::optional<Eigen::Vector3d> intersect_rays(const Pose& b_from_a, const Eigen::Matrix3d& b_E_a,
                                              const Eigen::Vector3d& ray_a,
                                              const Eigen::Vector3d& ray_b) {
  const RayPair rays = satisfy_epipolar(b_E_a, ray_a, ray_b);
  // depth_a * p + t = depth_b * q, in least squares for what rounding left of the epipolar error.
  const Eigen::Vector3d p = b_from_a.linear() * rays.a;
  const Eigen::Vector3d& q = rays.b;
  const double pp = p.squaredNorm();
  const double qq = q.squaredNorm();
  const double sine_squared = p.cross(q).squaredNorm();
  if (!(sine_squared > kParallelSineSquared * pp * qq)) return std::nullopt;
  const Eigen::Vector3d t = b_from_a.translation();
  const double depth_a = (p.dot(q) * q.dot(t) - qq * p.dot(t)) / sine_squared;
  return depth_a * rays.a;
}

std::optional<Eigen::Vector3d> triangulate(const Camera& camera, const Pose& a_from_world,
                                           const Eigen::Vector2d& pixel_a, const Pose& b_from_world,
                                           const Eigen::Vector2d& pixel_b) {
  const Pose world_from_a = a_from_world.inverse(Eigen::Isometry);
  const Pose b_from_a = b_from_world * world_from_a;
  const std::optional<Eigen::Vector3d> point_a = intersect_rays(
      b_from_a, essential_from_pose(b_from_a), camera.ray(pixel_a), camera.ray(pixel_b));
  if (!point_a || !(point_a->z() > 0.0) || !((b_from_a * *point_a).z() > 0.0)) return std::nullopt;
  return world_from_a * *point_a;
}

double parallax_cosine(const Pose& a_from_world, const Pose& b_from_world,
                       const Eigen::Vector3d& point_world) {
  // Turned back into the world, so that the two directions share axes.
  const Eigen::Vector3d from_a = a_from_world.linear().transpose() * (a_from_world * point_world);
  const Eigen::Vector3d from_b = b_from_world.linear().transpose() * (b_from_world * point_world);
  return from_a.dot(from_b) / std::sqrt(from_a.squaredNorm() * from_b.squaredNorm());
}

Eigen::Matrix3d essential_from_pose(const Pose& b_from_a) {
  return skew(b_from_a.translation()) * b_from_a.linear();
}

Eigen::Matrix3d fundamental_from_poses(const Camera& camera, const Pose& a_from_world,
                                       const Pose& b_from_world) {
  const Eigen::Matrix3d pixel_to_ray = calibration_matrix(camera).inverse();
  const Pose b_from_a = b_from_world * a_from_world.inverse(Eigen::Isometry);
  return pixel_to_ray.transpose() * essential_from_pose(b_from_a) * pixel_to_ray;
}

Eigen::Matrix3d calibration_matrix(const Camera& camera) {
  return (Eigen::Matrix3d() << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0)
      .finished();
}

}  // namespace planecast::slam
