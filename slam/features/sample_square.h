#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstring>
#include <opencv2/core.hpp>

namespace planecast::slam {

/// Grey values of a square of kSide x kSide pixels about `centre`, row by row, bilinear. False
/// where it reaches beyond the image (8-bit, one channel).
template <int kSide>
bool sample_square(const cv::Mat& image, const Eigen::Vector2f& centre,
                   Eigen::Array<float, kSide * kSide, 1>& values) {
  const float x = centre.x() - 0.5F * (kSide - 1);
  const float y = centre.y() - 0.5F * (kSide - 1);
  if (!(x >= 0.0F && y >= 0.0F && x < static_cast<float>(image.cols - kSide) &&
        y < static_cast<float>(image.rows - kSide))) {
    return false;
  }
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  // Row by row through buffers of its own, which the compiler knows to be apart from the image.
  const auto interpolate_row = [&](int row, std::array<float, kSide>& along) {
    std::array<uchar, kSide + 1> pixels;
    std::memcpy(pixels.data(), image.ptr<uchar>(row) + x0, kSide + 1);
    std::array<float, kSide + 1> grey;
    for (std::size_t u = 0; u <= kSide; ++u) grey[u] = static_cast<float>(pixels[u]);
    for (std::size_t u = 0; u < kSide; ++u) along[u] = grey[u] + fx * (grey[u + 1] - grey[u]);
  };
  std::array<float, kSide> upper;
  std::array<float, kSide> lower;
  interpolate_row(y0, upper);
  for (int v = 0; v < kSide; ++v) {
    interpolate_row(y0 + v + 1, lower);
    float* out = values.data() + v * kSide;
    for (std::size_t u = 0; u < kSide; ++u) out[u] = upper[u] + fy * (lower[u] - upper[u]);
    upper = lower;
  }
  return true;
}

}  // namespace planecast::slam
