#include "engine/look/camera_blur.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace planecast::engine {
namespace {

constexpr double kReblurSigma = 1.0;
/// What the measure gives for an antialiased edge without blur: central differences see it blurred.
/// Computed for a step through a pixel's box filter; it is between 0.56 and 0.70 for any blur and
/// phase.
constexpr double kSharpVariance = 0.68;

/// Widths (sigma) of the edges across which the picture rises along x.
std::vector<double> edge_widths_along_x(const cv::Mat& grey, const cv::Mat& blurred,
                                        const BlurOptions& options) {
  std::vector<double> widths;
  for (int y = 1; y + 1 < grey.rows; ++y) {
    const auto* row = grey.ptr<float>(y);
    const auto* above = grey.ptr<float>(y - 1);
    const auto* below = grey.ptr<float>(y + 1);
    const auto* soft = blurred.ptr<float>(y);
    for (int x = 2; x + 2 < grey.cols; ++x) {
      const float gx = row[x + 1] - row[x - 1];
      const float strength = std::abs(gx);
      if (strength < options.min_contrast || strength < 2.0F * std::abs(below[x] - above[x]))
        continue;
      // Only the crest of the edge, where the model holds.
      if (strength < std::abs(row[x] - row[x - 2]) || strength <= std::abs(row[x + 2] - row[x]))
        continue;
      const double ratio = gx / static_cast<double>(soft[x + 1] - soft[x - 1]);
      if (ratio < 1.02) continue;
      widths.push_back(kReblurSigma / std::sqrt(ratio * ratio - 1.0));
    }
  }
  return widths;
}

double blur_sigma(std::vector<double> widths, const BlurOptions& options) {
  if (static_cast<int>(widths.size()) < options.min_edges) return 0.0;
  const auto index =
      static_cast<std::ptrdiff_t>(options.sharp_share * static_cast<double>(widths.size()));
  std::nth_element(widths.begin(), widths.begin() + index, widths.end());
  const double sigma = widths[static_cast<std::size_t>(index)];
  return std::min(std::sqrt(std::max(0.0, sigma * sigma - kSharpVariance)), options.max_sigma_px);
}

}  // namespace

CameraBlur estimate_blur(const cv::Mat& grey, const BlurOptions& options) {
  cv::Mat sharp;
  grey.convertTo(sharp, CV_32F);
  cv::Mat soft;
  cv::GaussianBlur(sharp, soft, cv::Size(7, 7), kReblurSigma);
  CameraBlur blur;
  blur.sigma_x_px = blur_sigma(edge_widths_along_x(sharp, soft, options), options);
  blur.sigma_y_px = blur_sigma(edge_widths_along_x(sharp.t(), soft.t(), options), options);
  return blur;
}

void apply_blur(const CameraBlur& blur, ObjectLayer& layer) {
  const double sigma_x = blur.sigma_x_px < kVisibleBlur ? 0.0 : blur.sigma_x_px;
  const double sigma_y = blur.sigma_y_px < kVisibleBlur ? 0.0 : blur.sigma_y_px;
  if ((sigma_x == 0.0 && sigma_y == 0.0) || layer.bounds.empty()) return;
  const auto radius = [](double sigma) { return static_cast<int>(std::ceil(3.0 * sigma)); };
  const cv::Size kernel(2 * radius(sigma_x) + 1, 2 * radius(sigma_y) + 1);
  const cv::Rect whole(cv::Point(), layer.rgba.size());
  layer.bounds = cv::Rect(layer.bounds.x - radius(sigma_x), layer.bounds.y - radius(sigma_y),
                          layer.bounds.width + 2 * radius(sigma_x),
                          layer.bounds.height + 2 * radius(sigma_y)) &
                 whole;
  cv::Mat part = layer.rgba(layer.bounds);
  // A sigma of 0 would be taken from the kernel's size: give a width-1 kernel any positive one.
  cv::GaussianBlur(part, part, kernel, std::max(sigma_x, 0.1), std::max(sigma_y, 0.1));
}

}  // namespace planecast::engine
