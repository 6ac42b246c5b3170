#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "slam/data/frame.h"

namespace planecast::slam {

/// Halves a grey image until its shorter side would fall under `min_side_px`; at most `max_levels`.
ImagePyramid build_pyramid(const cv::Mat& grey, int max_levels = 6, int min_side_px = 24);

/// Pixel of level 0 -> the same point at a level. Pixel centres are integers at every level.
inline Eigen::Vector2f at_level(const Eigen::Vector2f& pixel, int level) {
  const float scale = 1.0F / static_cast<float>(1 << level);
  return ((pixel.array() + 0.5F) * scale - 0.5F).matrix();
}

/// Pixel of a level -> the same point at level 0.
inline Eigen::Vector2f from_level(const Eigen::Vector2f& pixel, int level) {
  const auto scale = static_cast<float>(1 << level);
  return ((pixel.array() + 0.5F) * scale - 0.5F).matrix();
}

}  // namespace planecast::slam
