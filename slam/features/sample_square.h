#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace planecast::slam {

/// Grey values of a square of kSide x kSide pixels about `centre`, row by row, bilinear. False where it
/// reaches beyond the image (8-bit, one channel).
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
  const float w00 = (1.0F - fx) * (1.0F - fy);
  const float w01 = fx * (1.0F - fy);
  const float w10 = (1.0F - fx) * fy;
  const float w11 = fx * fy;
  for (int v = 0; v < kSide; ++v) {
    const uchar* upper = image.ptr<uchar>(y0 + v) + x0;
    const uchar* lower = upper + image.step[0];
    for (int u = 0; u < kSide; ++u) {
      values[v * kSide + u] =
          w00 * static_cast<float>(upper[u]) + w01 * static_cast<float>(upper[u + 1]) +
          w10 * static_cast<float>(lower[u]) + w11 * static_cast<float>(lower[u + 1]);
    }
  }
  return true;
}

}  // namespace planecast::slam
