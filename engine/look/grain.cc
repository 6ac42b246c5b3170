#include "engine/look/grain.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace planecast::engine {
namespace {

/// SplitMix64 (Steele, Lea, Flood 2014): well mixed bits of consecutive numbers, the same
/// everywhere.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// Nearly Gaussian with unit variance: the sum of four uniform numbers, which needs no library
/// whose distribution may change.
float gaussian(std::uint64_t bits) {
  int sum = 0;
  for (int i = 0; i < 4; ++i) sum += static_cast<int>((bits >> (16 * i)) & 0xFFFFU);
  constexpr double kMean = 4 * 32767.5;
  constexpr double kDeviation = 65536.0 * 0.57735026918962576;  // sqrt(4 / 12)
  return static_cast<float>((sum - kMean) / kDeviation);
}

}  // namespace

double estimate_grain(const cv::Mat& grey) {
  std::vector<int> counts(512, 0);
  int total = 0;
  for (int y = 0; y + 1 < grey.rows; y += 2) {
    const auto* a = grey.ptr<std::uint8_t>(y);
    const auto* b = grey.ptr<std::uint8_t>(y + 1);
    for (int x = 0; x + 1 < grey.cols; x += 2) {
      // Clipped pixels have no noise and say nothing.
      if (a[x] == 0 || a[x] == 255) continue;
      ++counts[static_cast<std::size_t>(
          std::min(std::abs(a[x] - a[x + 1] - b[x] + b[x + 1]), 511))];
      ++total;
    }
  }
  if (total == 0) return 0.0;
  // The coefficient is half of the sum counted here; within a bin values are spread evenly.
  int below = 0;
  std::size_t bin = 0;
  while (2 * (below + counts[bin]) < total) below += counts[bin++];
  const double within = (0.5 * total - below) / std::max(counts[bin], 1);
  const double median = bin == 0 ? 0.5 * within : static_cast<double>(bin) - 0.5 + within;
  return 0.5 * median / 0.6745;
}

Grain::Grain(std::uint64_t seed) : seed_(seed), tile_(kTile, kTile, CV_32FC1) {
  std::uint64_t counter = mix(seed ^ 0x6772'6169'6eULL);
  for (int y = 0; y < kTile; ++y) {
    for (int x = 0; x < kTile; ++x) tile_.at<float>(y, x) = gaussian(mix(counter++));
  }
}

void Grain::apply(double sigma, int frame, ObjectLayer& layer) const {
  if (sigma < kVisibleGrain || layer.depth.empty()) return;
  const std::uint64_t place = mix(seed_ + 0x1000003ULL * static_cast<std::uint64_t>(frame));
  const int shift_x = static_cast<int>(place % kTile);
  const int shift_y = static_cast<int>((place >> 32) % kTile);
  for (int y = layer.bounds.y; y < layer.bounds.br().y; ++y) {
    auto* pixels = layer.rgba.ptr<cv::Vec4b>(y);
    const auto* depth = layer.depth.ptr<float>(y);
    const auto* noise = tile_.ptr<float>((y + shift_y) % kTile);
    for (int x = layer.bounds.x; x < layer.bounds.br().x; ++x) {
      cv::Vec4b& pixel = pixels[x];
      if (depth[x] <= 0.0F || pixel[3] == 0) continue;
      const double alpha = pixel[3] / 255.0;
      const int change =
          static_cast<int>(std::lround(noise[(x + shift_x) % kTile] * sigma * alpha));
      for (int c = 0; c < 3; ++c) {
        pixel[c] =
            static_cast<std::uint8_t>(std::clamp(pixel[c] + change, 0, static_cast<int>(pixel[3])));
      }
    }
  }
}

}  // namespace planecast::engine
