#include "engine/sequence/synth/camera_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3d;

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// Camera axes (x right, y down, z forward) looking from eye to target with the horizon level.
Eigen::Matrix3d look_at(const Vector3d& eye, const Vector3d& target) {
  const Vector3d forward = (target - eye).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d world_from_cam;
  world_from_cam << right, forward.cross(right), forward;
  return world_from_cam;
}

Vector3d hermite(const Vector3d& a, const Vector3d& b, const Vector3d& slope_a,
                 const Vector3d& slope_b, double t, double step) {
  const double t2 = t * t;
  const double t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * step * slope_a + (-2 * t3 + 3 * t2) * b +
         (t3 - t2) * step * slope_b;
}

}  // namespace

CameraPath::CameraPath(std::vector<PathKey> keys, const HandheldOptions& options,
                       std::uint64_t seed, double duration_s)
    : keys_(std::move(keys)), options_(options) {
  duration_s_ = duration_s > 0.0 ? duration_s : keys_.back().time_s;
  Random random(seed);
  for (Wander& wander : wander_) {
    double variance = 0.0;
    for (std::size_t i = 0; i < wander.frequency_hz.size(); ++i) {
      wander.frequency_hz[i] = random.uniform(0.12, 0.3) * std::pow(1.75, static_cast<double>(i));
      wander.phase[i] = random.uniform(0.0, 2.0 * std::numbers::pi);
      wander.amplitude[i] = 1.0 / (0.3 + wander.frequency_hz[i]);  // a hand moves little when fast
      variance += 0.5 * wander.amplitude[i] * wander.amplitude[i];
    }
    for (double& amplitude : wander.amplitude) amplitude /= std::sqrt(variance);
  }
}

double CameraPath::Wander::at(double time_s) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < frequency_hz.size(); ++i) {
    sum += amplitude[i] * std::sin(2.0 * std::numbers::pi * frequency_hz[i] * time_s + phase[i]);
  }
  return sum;
}

PathKey CameraPath::interpolate(double time_s) const {
  if (time_s <= keys_.front().time_s) return keys_.front();
  if (time_s >= keys_.back().time_s) return keys_.back();
  std::size_t next = 1;
  while (keys_[next].time_s < time_s) ++next;
  const auto slope = [this](std::size_t i, Vector3d PathKey::*member) -> Vector3d {
    const PathKey& before = keys_[i == 0 ? 0 : i - 1];
    const PathKey& after = keys_[std::min(i + 1, keys_.size() - 1)];
    return (after.*member - before.*member) / (after.time_s - before.time_s);
  };
  const PathKey& a = keys_[next - 1];
  const PathKey& b = keys_[next];
  const double step = b.time_s - a.time_s;
  const double t = (time_s - a.time_s) / step;
  PathKey key;
  key.time_s = time_s;
  key.eye =
      hermite(a.eye, b.eye, slope(next - 1, &PathKey::eye), slope(next, &PathKey::eye), t, step);
  key.target = hermite(a.target, b.target, slope(next - 1, &PathKey::target),
                       slope(next, &PathKey::target), t, step);
  return key;
}

slam::Pose CameraPath::world_from_cam(double time_s) const {
  const PathKey key = interpolate(time_s);
  const double walk = 2.0 * std::numbers::pi * options_.step_hz * time_s;
  Vector3d eye = key.eye;
  eye += options_.sway_m *
         Vector3d(wander_[0].at(time_s), wander_[1].at(time_s), 0.7 * wander_[2].at(time_s));
  Eigen::Matrix3d rotation = look_at(key.eye, key.target);
  // One step up and down per foot, one sway to the side per pair of steps.
  eye += options_.bob_m * std::sin(walk) * Vector3d::UnitZ();
  eye += 0.6 * options_.bob_m * std::sin(0.5 * walk) * rotation.col(0);
  const double shake = options_.shake_deg * kRadiansPerDegree;
  const double roll = options_.roll_deg * kRadiansPerDegree;
  rotation = rotation * Eigen::AngleAxisd(shake * wander_[3].at(time_s), Vector3d::UnitY()) *
             Eigen::AngleAxisd(shake * wander_[4].at(time_s), Vector3d::UnitX()) *
             Eigen::AngleAxisd(roll * wander_[5].at(time_s), Vector3d::UnitZ());
  slam::Pose pose = slam::Pose::Identity();
  pose.linear() = rotation;
  pose.translation() = eye;
  return pose;
}

}  // namespace planecast::engine::synth
