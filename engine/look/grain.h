#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "engine/look/object_layer.h"

namespace planecast::engine {

/// Standard deviation of a picture's noise in grey levels: the median of the finest diagonal Haar
/// coefficients over 0.6745 (Donoho and Johnstone 1994), which edges hardly touch. `grey` is
/// CV_8UC1.
double estimate_grain(const cv::Mat& grey);

/// Less is lost in the rounding: not applied.
inline constexpr double kVisibleGrain = 0.3;  ///< grey levels

/// Noise for the object layer: a tile of Gaussian values made once from the seed, laid at a place
/// that depends on the seed and the frame's number, so that no two frames carry the same grain and
/// every run does.
class Grain {
 public:
  explicit Grain(std::uint64_t seed);
  /// Adds noise of `sigma` grey levels to the pixels that objects cover; colours stay within alpha.
  void apply(double sigma, int frame, ObjectLayer& layer) const;

 private:
  static constexpr int kTile = 256;
  std::uint64_t seed_;
  cv::Mat tile_;  ///< CV_32F, unit variance, repeats in both directions
};

}  // namespace planecast::engine
