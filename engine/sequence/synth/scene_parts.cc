#include "engine/sequence/synth/scene_parts.h"

#include <cmath>
#include <numbers>

#include "engine/sequence/synth/furniture.h"

namespace planecast::engine::synth {

using Eigen::Vector3d;

namespace {

constexpr double kRadians = std::numbers::pi / 180.0;

}  // namespace

Decal hang(PrintKind kind, double u, double v, double width, double height, std::uint64_t seed) {
  return {static_cast<float>(u),
          static_cast<float>(v),
          static_cast<float>(width),
          static_cast<float>(height),
          print(kind, width, height, seed),
          0.012F,
          0.0F};
}

Decal lay(PrintKind kind, double u, double v, double width, double height, double yaw,
          std::uint64_t seed) {
  Decal decal = hang(kind, u, v, width, height, seed);
  decal.shadow_m = 0.004F;
  decal.yaw = static_cast<float>(yaw);
  return decal;
}

Decal spread_rug(double u, double v, double width, double height, std::uint32_t seed) {
  const auto w = static_cast<float>(width);
  const auto h = static_cast<float>(height);
  return {static_cast<float>(u), static_cast<float>(v), w, h, rug(w, h, seed), 0.015F, 0.0F};
}

Eigen::Vector3f sun_direction(double x, double y, double z) {
  return Vector3d(x, y, z).normalized().cast<float>();
}

std::vector<PathKey> orbit(const Vector3d& centre, const std::vector<OrbitStep>& steps,
                           double step_s) {
  std::vector<PathKey> keys;
  for (const OrbitStep& step : steps) {
    const double a = step.azimuth_deg * kRadians;
    PathKey key;
    key.time_s = step_s * static_cast<double>(keys.size());
    key.eye = Vector3d(centre.x() + step.radius_m * std::cos(a),
                       centre.y() + step.radius_m * std::sin(a), step.height_m);
    key.target = Vector3d(centre.x(), centre.y(), step.look_height_m);
    keys.push_back(key);
  }
  return keys;
}

}  // namespace planecast::engine::synth
