#include "slam/data/camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace planecast::slam {
namespace {

/// Normalised undistorted -> normalised distorted coordinates, OpenCV's radial-tangential model.
Eigen::Vector2d distort_radial_tangential(const Eigen::Vector2d& p,
                                          const std::array<double, 5>& d) {
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  const double xy = p.x() * p.y();
  return {p.x() * radial + 2.0 * d[2] * xy + d[3] * (r2 + 2.0 * p.x() * p.x()),
          p.y() * radial + d[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * d[3] * xy};
}

/// Kannala-Brandt: theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8).
double fisheye_angle(double theta, const std::array<double, 5>& d) {
  const double t2 = theta * theta;
  return theta * (1.0 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3]))));
}

Eigen::Vector2d distort_fisheye(const Eigen::Vector2d& p, const std::array<double, 5>& d) {
  const double r = p.norm();
  if (r < 1e-9) return p;
  return p * (fisheye_angle(std::atan(r), d) / r);
}

Eigen::Vector2d undistort_fisheye(const Eigen::Vector2d& p, const std::array<double, 5>& d) {
  const double target = p.norm();
  if (target < 1e-9) return p;
  double theta = target;
  for (int i = 0; i < 20; ++i) {
    const double step = 1e-6;
    const double value = fisheye_angle(theta, d);
    const double slope = (fisheye_angle(theta + step, d) - value) / step;
    if (std::abs(slope) < 1e-9) break;
    const double delta = (target - value) / slope;
    theta += delta;
    if (std::abs(delta) < 1e-12) break;
  }
  // Rays at or beyond 90 degrees have no pinhole pixel: they are pushed far outside the image.
  theta = std::clamp(theta, 0.0, 0.5 * std::numbers::pi - 1e-3);
  return p * (std::tan(theta) / target);
}

/// Newton's method with a numeric 2x2 Jacobian: the fixed-point iteration diverges at strong
/// lenses.
Eigen::Vector2d undistort_radial_tangential(const Eigen::Vector2d& target,
                                            const std::array<double, 5>& d) {
  Eigen::Vector2d p = target;
  const double step = 1e-6;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d value = distort_radial_tangential(p, d);
    const Eigen::Vector2d dx =
        (distort_radial_tangential(p + Eigen::Vector2d(step, 0), d) - value) / step;
    const Eigen::Vector2d dy =
        (distort_radial_tangential(p + Eigen::Vector2d(0, step), d) - value) / step;
    Eigen::Matrix2d jacobian;
    jacobian << dx, dy;
    if (std::abs(jacobian.determinant()) < 1e-9) break;
    const Eigen::Vector2d delta = jacobian.inverse() * (target - value);
    p += delta;
    if (delta.norm() < 1e-11) break;
  }
  return p;
}

}  // namespace

bool Camera::has_distortion() const {
  return lens == LensModel::kFisheye ||
         std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0.0; });
}

Eigen::Vector2d Camera::undistort(const Eigen::Vector2d& raw_pixel) const {
  if (!has_distortion()) return raw_pixel;
  const Eigen::Vector2d p = ray(raw_pixel).head<2>();
  const Eigen::Vector2d u = lens == LensModel::kFisheye
                                ? undistort_fisheye(p, distortion)
                                : undistort_radial_tangential(p, distortion);
  return project(u.homogeneous());
}

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& pixel) const {
  if (!has_distortion()) return pixel;
  const Eigen::Vector2d p = ray(pixel).head<2>();
  const Eigen::Vector2d d = lens == LensModel::kFisheye ? distort_fisheye(p, distortion)
                                                        : distort_radial_tangential(p, distortion);
  return project(d.homogeneous());
}

Camera Camera::scaled_to(int new_width, int new_height) const {
  Camera scaled = *this;
  const double sx = static_cast<double>(new_width) / width;
  const double sy = static_cast<double>(new_height) / height;
  scaled.width = new_width;
  scaled.height = new_height;
  scaled.fx = fx * sx;
  scaled.fy = fy * sy;
  // Pixel centres are integers, so the image's edge lies at -0.5.
  scaled.cx = (cx + 0.5) * sx - 0.5;
  scaled.cy = (cy + 0.5) * sy - 0.5;
  return scaled;
}

Camera guess_camera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  const double half_view = 30.0 * std::numbers::pi / 180.0;
  camera.fx = camera.fy = 0.5 * std::max(width, height) / std::tan(half_view);
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  camera.guessed = true;
  return camera;
}

}  // namespace planecast::slam
