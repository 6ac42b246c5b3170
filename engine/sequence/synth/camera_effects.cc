#include "engine/sequence/synth/camera_effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "engine/sequence/synth/noise.h"
#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

namespace {

constexpr int kGainBits = 8;
constexpr std::size_t kTape = 1U << 18;  // a power of two, longer than repetition is seen

/// Averages along the line that a point draws while the shutter is open.
void blur_along(cv::Mat& bgr, const Eigen::Vector2d& step_px) {
  const double length = std::min(step_px.norm(), 15.0);
  if (length < 0.8) return;
  const int half = static_cast<int>(std::ceil(0.5 * length));
  cv::Mat kernel = cv::Mat::zeros(2 * half + 1, 2 * half + 1, CV_32F);
  constexpr int kSamples = 32;
  for (int i = 0; i < kSamples; ++i) {
    const double t = (i + 0.5) / kSamples - 0.5;
    const Eigen::Vector2d at = t * length * step_px.normalized();
    const int x = static_cast<int>(std::lround(at.x())) + half;
    const int y = static_cast<int>(std::lround(at.y())) + half;
    kernel.at<float>(y, x) += 1.0F / kSamples;
  }
  cv::filter2D(bgr, bgr, -1, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
}

/// What an automatic exposure of few steps does.
double jumped_exposure(double time_s) {
  constexpr double kEvery_s = 1.1;
  constexpr std::array<double, 5> kGains = {1.0, 0.45, 1.3, 0.6, 1.6};
  return kGains[static_cast<std::size_t>(time_s / kEvery_s) % kGains.size()];
}

double exposure_at(double time_s, double drift) {
  return 1.0 + drift * (0.6 * std::sin(0.55 * time_s + 0.4) + 0.4 * std::sin(1.3 * time_s + 2.0));
}

}  // namespace

CameraEffects::CameraEffects(const EffectOptions& options, int width, int height,
                             std::uint64_t seed)
    : options_(options), seed_(seed) {
  const double cx = 0.5 * (width - 1);
  const double cy = 0.5 * (height - 1);
  const double corner = cx * cx + cy * cy;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double r2 = ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / corner;
      const double light = 1.0 - options.vignetting * r2;
      // Values are sRGB-encoded: light counts to the power of about 1 / 2.2.
      gain_.push_back(
          static_cast<std::uint16_t>(std::lround(std::pow(light, 1.0 / 2.2) * (1 << kGainBits))));
    }
  }
  Random random(seed);
  noise_.resize(kTape);
  for (std::int8_t& value : noise_) {
    const double sample = 16.0 * options.noise_sigma * random.normal();
    value = static_cast<std::int8_t>(std::lround(std::clamp(sample, -127.0, 127.0)));
  }
}

void CameraEffects::apply(cv::Mat& bgr, int frame, double time_s,
                          const Eigen::Vector2d& flow_px_per_s) const {
  blur_along(bgr, options_.shutter_s * flow_px_per_s);
  double light = exposure_at(time_s, options_.exposure_drift);
  if (options_.exposure_jumps) light *= jumped_exposure(time_s);
  const double encoded = std::pow(light, 1.0 / 2.2);
  const int exposure = static_cast<int>(std::lround(encoded * 256.0));
  for (int y = 0; y < bgr.rows; ++y) {
    auto* pixel = bgr.ptr<std::uint8_t>(y);
    const std::uint16_t* gain =
        &gain_[static_cast<std::size_t>(y) * static_cast<std::size_t>(bgr.cols)];
    // Every row begins at a place of the tape of its own.
    const std::uint64_t start =
        mix_bits(seed_ ^ mix_bits(static_cast<std::uint64_t>(frame) * 65536U +
                                  static_cast<std::uint64_t>(y)));
    auto at = static_cast<std::size_t>(start);
    for (int x = 0; x < bgr.cols; ++x, pixel += 3) {
      const int scale = gain[x] * exposure;  // 16 bits of fraction
      for (int c = 0; c < 3; ++c) {
        const int value = (pixel[c] * scale + (noise_[at++ & (kTape - 1)] << 12) + 32768) >> 16;
        pixel[c] = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
      }
    }
  }
}

cv::Mat covered_lens(int width, int height, int frame, std::uint64_t seed) {
  cv::Mat bgr(height, width, CV_8UC3);
  const auto noise_seed =
      static_cast<std::uint32_t>(mix_bits(seed ^ static_cast<std::uint64_t>(frame)));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float grain = 5.0F * (cell_random(x, y, noise_seed) - 0.5F);
      const float glow = 10.0F * static_cast<float>(x) / static_cast<float>(width);
      bgr.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(10.0F + grain),
                                 static_cast<std::uint8_t>(12.0F + grain + 0.4F * glow),
                                 static_cast<std::uint8_t>(24.0F + grain + glow)};
    }
  }
  return bgr;
}

void degrade_depth(cv::Mat& depth_m, double fx, int frame, std::uint64_t seed) {
  constexpr float kNearest = 0.4F;
  constexpr float kEdgeShare = 0.035F;   // a step of this share of the depth is an edge
  constexpr float kGrazingSlope = 5.5F;  // tangent of the angle between normal and view
  const cv::Mat exact = depth_m.clone();
  const auto hole_seed =
      static_cast<std::uint32_t>(mix_bits(seed + static_cast<std::uint64_t>(frame)));
  Random random(mix_bits(seed ^ mix_bits(static_cast<std::uint64_t>(frame))));
  const int reach = std::max(1, depth_m.cols / 240);
  for (int y = 0; y < depth_m.rows; ++y) {
    const int above = std::max(y - reach, 0);
    const int below = std::min(y + reach, depth_m.rows - 1);
    for (int x = 0; x < depth_m.cols; ++x) {
      const float z = exact.at<float>(y, x);
      float& out = depth_m.at<float>(y, x);
      if (z < kNearest) {
        out = 0.0F;
        continue;
      }
      const int left = std::max(x - reach, 0);
      const int right = std::min(x + reach, depth_m.cols - 1);
      const float across = exact.at<float>(y, right) - exact.at<float>(y, left);
      const float down = exact.at<float>(below, x) - exact.at<float>(above, x);
      const float slope = std::hypot(across, down) * static_cast<float>(fx) /
                          (2.0F * static_cast<float>(reach) * z);
      // The projector stands beside the camera: its shadow lies on the left of what is near.
      const bool edge = std::abs(across) > kEdgeShare * z || std::abs(down) > 1.5F * kEdgeShare * z;
      const float luck = cell_random(x, y, hole_seed);
      const bool grazing = slope > kGrazingSlope && luck < 0.7F;
      if ((edge && (across < 0.0F || luck < 0.35F)) || grazing) {
        out = 0.0F;
        continue;
      }
      const float sigma = 0.0012F + 0.0019F * (z - 0.4F) * (z - 0.4F);
      // Three uniforms are near enough to a normal distribution, and cheap.
      const double sum = random.uniform() + random.uniform() + random.uniform() - 1.5;
      out = z + sigma * static_cast<float>(2.0 * sum);
    }
  }
}

}  // namespace planecast::engine::synth
