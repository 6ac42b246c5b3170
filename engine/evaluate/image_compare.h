#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace planecast::engine {

/// How far two 8-bit images of the same size and channels differ.
struct ImageDifference {
  bool comparable = false;  ///< same size and type; else all figures are at their worst
  std::array<int, 4> max_by_channel = {255, 255, 255, 255};  ///< unused channels: 0
  int max_difference = 255;
  double mean_difference = 255.0;  ///< over all channels
  double share_beyond = 1.0;       ///< of the pixels with any channel beyond the limit
  double ssim = -1.0;              ///< 1 for identical images
};

/// `limit`: a channel may differ by so much before its pixel counts as beyond. SSIM as in Wang et
/// al. 2004 (11x11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03), mean over pixels and
/// channels; images smaller than the window are padded by reflection.
ImageDifference compare_images(const cv::Mat& expected, const cv::Mat& actual, int limit = 5);

/// |expected - actual| scaled by `gain` for the eye, BGR.
cv::Mat difference_picture(const cv::Mat& expected, const cv::Mat& actual, double gain = 8.0);

/// Peak signal-to-noise ratio in dB of 8-bit images; infinity for identical ones.
double psnr(const cv::Mat& expected, const cv::Mat& actual);

}  // namespace planecast::engine
