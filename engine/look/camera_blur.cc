#include "engine/look/camera_blur.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace planecast::engine {
namespace {

constexpr double kReblurSigma = 1.0;
/// What the measure gives for an antialiased edge without blur: central differences see it blurred.
/// Computed for a step through a pixel's box filter; it is between 0.56 and 0.70 for any blur and
/// phase.
constexpr double kSharpVariance = 0.68;

/// Reaches of the second blur, across an edge and along it.
constexpr int kAlongReach = 3;
constexpr int kAcrossReach = kAlongReach + 1;
/// Of every so many rows edges are looked for: thousands are as good as twice as many.
constexpr int kRowStep = 2;

/// The central difference across an edge of the picture blurred once more, taken where it is needed
/// alone: two separable kernels.
class BlurredDifference {
 public:
  BlurredDifference() {
    const cv::Mat kernel = cv::getGaussianKernel(2 * kAlongReach + 1, kReblurSigma, CV_32F);
    const auto weight = [&](int k) {
      return std::abs(k) <= kAlongReach ? kernel.at<float>(k + kAlongReach) : 0.0F;
    };
    for (int k = -kAlongReach; k <= kAlongReach; ++k) along_[index(k, kAlongReach)] = weight(k);
    for (int k = -kAcrossReach; k <= kAcrossReach; ++k) {
      across_[index(k, kAcrossReach)] = weight(k - 1) - weight(k + 1);
    }
  }

  /// `pixel` lies in a picture with a border as wide as the reaches; the steps lead to its
  /// neighbours across and along the edge.
  float at(const std::uint8_t* pixel, std::ptrdiff_t across, std::ptrdiff_t along) const {
    float sum = 0.0F;
    for (int j = -kAlongReach; j <= kAlongReach; ++j) {
      const std::uint8_t* line = pixel + j * along;
      float line_sum = 0.0F;
      for (int k = -kAcrossReach; k <= kAcrossReach; ++k) {
        line_sum += across_[index(k, kAcrossReach)] * static_cast<float>(line[k * across]);
      }
      sum += along_[index(j, kAlongReach)] * line_sum;
    }
    return sum;
  }

 private:
  static std::size_t index(int k, int reach) { return static_cast<std::size_t>(k + reach); }

  std::array<float, 2 * kAlongReach + 1> along_{};
  std::array<float, 2 * kAcrossReach + 1> across_{};
};

/// How to walk over a picture: to the neighbours across and along the edges looked for.
struct Steps {
  std::ptrdiff_t across = 0;
  std::ptrdiff_t along = 0;
};

/// Whether each of `count` pixels stands on the crest of an edge, where the model holds: it rises
/// by `least` at least, twice as much as along the edge, and most of all in its neighbourhood. No
/// branches, so that the compiler takes many pixels at once.
void find_crests(const std::uint8_t* pixels, int count, const Steps& steps, int least,
                 std::uint8_t* crests) {
  const std::ptrdiff_t across = steps.across;
  const std::ptrdiff_t along = steps.along;
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* p = pixels + i;
    const int strength = std::abs(p[across] - p[-across]);
    const bool strong = (strength >= least) & (strength >= 2 * std::abs(p[along] - p[-along]));
    const bool crest =
        (strength >= std::abs(p[0] - p[-2 * across])) & (strength > std::abs(p[2 * across] - p[0]));
    crests[i] = strong & crest ? 1 : 0;
  }
}

/// Widths (sigma) of the edges across which the picture rises along x, or along y when `down`.
/// `bordered`: the picture with a border of kAcrossReach pixels.
std::vector<double> edge_widths(const cv::Mat& bordered, bool down, const BlurOptions& options) {
  std::vector<double> widths;
  const BlurredDifference blurred;
  const auto least = static_cast<int>(std::ceil(options.min_contrast));
  const auto row_step = static_cast<std::ptrdiff_t>(bordered.step);
  const Steps steps = down ? Steps{row_step, 1} : Steps{1, row_step};
  const cv::Point margin =
      cv::Point(kAcrossReach, kAcrossReach) + (down ? cv::Point(1, 2) : cv::Point(2, 1));
  const int count = bordered.cols - 2 * margin.x;
  std::vector<std::uint8_t> crests(static_cast<std::size_t>(std::max(count, 0)));
  for (int y = margin.y; y + margin.y < bordered.rows; y += kRowStep) {
    const std::uint8_t* row = bordered.ptr<std::uint8_t>(y) + margin.x;
    find_crests(row, count, steps, least, crests.data());
    for (int i = 0; i < count; ++i) {
      if (crests[static_cast<std::size_t>(i)] == 0) continue;
      const std::uint8_t* p = row + i;
      const int rise = p[steps.across] - p[-steps.across];
      const double ratio = rise / static_cast<double>(blurred.at(p, steps.across, steps.along));
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
  cv::Mat bordered;
  cv::copyMakeBorder(grey, bordered, kAcrossReach, kAcrossReach, kAcrossReach, kAcrossReach,
                     cv::BORDER_REFLECT_101);
  CameraBlur blur;
  blur.sigma_x_px = blur_sigma(edge_widths(bordered, false, options), options);
  blur.sigma_y_px = blur_sigma(edge_widths(bordered, true, options), options);
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
