#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace planecast::slam {

/// Rotation by the vector `omega` (axis times angle in radians).
inline Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  // sin(angle / 2) / angle; its series where the quotient loses digits.
  const double factor = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), factor * omega.x(), factor * omega.y(),
                            factor * omega.z())
      .normalized();
}

}  // namespace planecast::slam
