#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace planecast::engine::synth {

/// What a small camera does to a picture. All mild by default.
struct EffectOptions {
  double noise_sigma = 1.8;      ///< grey levels in mid tones
  double vignetting = 0.22;      ///< loss of light in the corners
  double exposure_drift = 0.06;  ///< largest relative change over time
  bool exposure_jumps = false;   ///< from one frame to the next, every second or so
  double shutter_s = 0.007;      ///< for the blur of turning
};

/// Applies blur, vignetting, exposure and noise to 8-bit BGR pictures of one size, in place.
class CameraEffects {
 public:
  CameraEffects(const EffectOptions& options, int width, int height, std::uint64_t seed);

  /// `flow_px_per_s`: how the middle of the picture moves.
  void apply(cv::Mat& bgr, int frame, double time_s, const Eigen::Vector2d& flow_px_per_s) const;

 private:
  EffectOptions options_;
  std::uint64_t seed_;
  std::vector<std::uint16_t> gain_;  ///< 1.8 fixed point, per pixel
  std::vector<std::int8_t> noise_;   ///< 1/16 grey levels, a long tape
};

/// A lens covered by a hand: dark, reddish, noisy.
cv::Mat covered_lens(int width, int height, int frame, std::uint64_t seed);

/// What a structured-light sensor makes of exact depth (CV_32F metres along z, in place): noise of
/// sigma_z = 0.0012 + 0.0019 (z - 0.4)^2 (Nguyen et al. 2012), holes beside depth edges and at
/// grazing surfaces, nothing nearer than 0.4 m. `fx` in pixels.
void degrade_depth(cv::Mat& depth_m, double fx, int frame, std::uint64_t seed);

}  // namespace planecast::engine::synth
