#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "slam/data/types.h"

namespace planecast::engine::synth {

/// Where the camera is and what it looks at, at a time.
struct PathKey {
  double time_s = 0.0;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  ///< world, metres, z up
  Eigen::Vector3d target = Eigen::Vector3d::UnitX();
};

/// How a hand holds it.
struct HandheldOptions {
  double sway_m = 0.012;    ///< slow wandering of the position, standard deviation
  double shake_deg = 0.45;  ///< of the direction
  double roll_deg = 0.6;
  double bob_m = 0.0;  ///< vertical amplitude of walking
  double step_hz = 1.8;
};

/// A smooth handheld path: cubic through the keys, with smooth noise from the seed on top. Times
/// before the first and after the last key hold their positions.
class CameraPath {
 public:
  CameraPath() = default;
  /// `duration_s`: of the sequence that is made of it unless more is asked for; 0: to the last key.
  CameraPath(std::vector<PathKey> keys, const HandheldOptions& options, std::uint64_t seed,
             double duration_s = 0.0);

  double duration_s() const { return duration_s_; }
  slam::Pose world_from_cam(double time_s) const;

 private:
  /// Sum of sines of different frequencies with unit variance.
  struct Wander {
    std::array<double, 5> frequency_hz{};
    std::array<double, 5> phase{};
    std::array<double, 5> amplitude{};
    double at(double time_s) const;
  };
  PathKey interpolate(double time_s) const;

  std::vector<PathKey> keys_;
  HandheldOptions options_;
  double duration_s_ = 0.0;
  std::array<Wander, 6> wander_;  ///< position x, y, z; yaw, pitch, roll
};

}  // namespace planecast::engine::synth
