#include "engine/evaluate/image_compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace planecast::engine {
namespace {

bool is_comparable(const cv::Mat& a, const cv::Mat& b) {
  return !a.empty() && a.size() == b.size() && a.type() == b.type() && a.depth() == CV_8U &&
         a.channels() <= 4;
}

cv::Mat window_mean(const cv::Mat& image) {
  cv::Mat mean;
  cv::GaussianBlur(image, mean, cv::Size(11, 11), 1.5, 1.5, cv::BORDER_REFLECT);
  return mean;
}

double structural_similarity(const cv::Mat& a8, const cv::Mat& b8) {
  constexpr double kC1 = 0.01 * 255.0 * 0.01 * 255.0;
  constexpr double kC2 = 0.03 * 255.0 * 0.03 * 255.0;
  cv::Mat a;
  cv::Mat b;
  a8.convertTo(a, CV_64F);
  b8.convertTo(b, CV_64F);
  const cv::Mat mean_a = window_mean(a);
  const cv::Mat mean_b = window_mean(b);
  const cv::Mat mean_ab = mean_a.mul(mean_b);
  const cv::Mat mean_aa = mean_a.mul(mean_a);
  const cv::Mat mean_bb = mean_b.mul(mean_b);
  const cv::Mat variance_a = window_mean(a.mul(a)) - mean_aa;
  const cv::Mat variance_b = window_mean(b.mul(b)) - mean_bb;
  const cv::Mat covariance = window_mean(a.mul(b)) - mean_ab;
  const cv::Scalar c1 = cv::Scalar::all(kC1);
  const cv::Scalar c2 = cv::Scalar::all(kC2);
  const cv::Mat above = cv::Mat(2.0 * mean_ab + c1).mul(cv::Mat(2.0 * covariance + c2));
  const cv::Mat below = cv::Mat(mean_aa + mean_bb + c1).mul(cv::Mat(variance_a + variance_b + c2));
  const cv::Scalar mean = cv::mean(cv::Mat(above / below));
  double sum = 0.0;
  for (int c = 0; c < a8.channels(); ++c) sum += mean[c];
  return sum / a8.channels();
}

}  // namespace

ImageDifference compare_images(const cv::Mat& expected, const cv::Mat& actual, int limit) {
  ImageDifference result;
  if (!is_comparable(expected, actual)) return result;
  result.comparable = true;
  result.max_by_channel = {};
  const int channels = expected.channels();
  std::int64_t sum = 0;
  std::int64_t beyond = 0;
  for (int row = 0; row < expected.rows; ++row) {
    const auto* a = expected.ptr<std::uint8_t>(row);
    const auto* b = actual.ptr<std::uint8_t>(row);
    for (int col = 0; col < expected.cols; ++col) {
      int worst = 0;
      for (int c = 0; c < channels; ++c) {
        const int difference = std::abs(*a++ - *b++);
        int& channel_max = result.max_by_channel[static_cast<std::size_t>(c)];
        channel_max = std::max(channel_max, difference);
        worst = std::max(worst, difference);
        sum += difference;
      }
      if (worst > limit) ++beyond;
    }
  }
  const auto pixels = static_cast<double>(expected.total());
  result.max_difference =
      *std::max_element(result.max_by_channel.begin(), result.max_by_channel.end());
  result.mean_difference = static_cast<double>(sum) / (pixels * channels);
  result.share_beyond = static_cast<double>(beyond) / pixels;
  result.ssim = structural_similarity(expected, actual);
  return result;
}

cv::Mat difference_picture(const cv::Mat& expected, const cv::Mat& actual, double gain) {
  if (!is_comparable(expected, actual)) return {};
  cv::Mat difference;
  cv::absdiff(expected, actual, difference);
  difference.convertTo(difference, -1, gain);
  if (difference.channels() == 4) cv::cvtColor(difference, difference, cv::COLOR_BGRA2BGR);
  if (difference.channels() == 1) cv::cvtColor(difference, difference, cv::COLOR_GRAY2BGR);
  return difference;
}

double psnr(const cv::Mat& expected, const cv::Mat& actual) {
  if (!is_comparable(expected, actual)) return 0.0;
  const double error = cv::norm(expected, actual, cv::NORM_L2SQR) /
                       static_cast<double>(expected.total() * expected.elemSize());
  if (error == 0.0) return std::numeric_limits<double>::infinity();
  return 10.0 * std::log10(255.0 * 255.0 / error);
}

}  // namespace planecast::engine
