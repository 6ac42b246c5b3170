#include "slam/features/patch.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "slam/data/vector_clones.h"
#include "slam/features/sample_square.h"

namespace planecast::slam {
namespace {

/// Offset of the first sample from the patch's centre: the patch has an even side.
constexpr float kFirst = -0.5F * (kPatchSide - 1);
constexpr int kRim = kSampledSide;
/// Least eigenvalue of the gradients' second moments, per pixel: in squared grey values.
constexpr float kMinMoment = 2.0F;

bool inside(const cv::Mat& image, const Eigen::Vector2f& pixel) {
  return pixel.x() >= 0.0F && pixel.y() >= 0.0F && pixel.x() < static_cast<float>(image.cols - 1) &&
         pixel.y() < static_cast<float>(image.rows - 1);
}

/// Samples the patch with a rim of one sample; false beyond the image.
PLANECAST_VECTOR_CLONES
bool sample_with_rim(const cv::Mat& image, const Eigen::Vector2f& centre,
                     const Eigen::Matrix2f& ref_from_patch, PatchSamples& rim) {
  const float first = kFirst - 1.0F;
  const float last = first + kRim - 1;
  for (const float v : {first, last}) {
    for (const float u : {first, last}) {
      if (!inside(image, centre + ref_from_patch * Eigen::Vector2f(u, v))) return false;
    }
  }
  // In sweeps, all of which but the second are vectors: places, pixels, values. The four pixels
  // about a place travel as one word.
  constexpr std::size_t kSamples = kRim * kRim;
  std::array<float, kSamples> x;
  std::array<float, kSamples> y;
  std::array<std::int32_t, kSamples> offset;
  const Eigen::Vector2f begin = centre + ref_from_patch * Eigen::Vector2f(first, first);
  for (std::size_t v = 0; v < kRim; ++v) {
    const float x_row = begin.x() + static_cast<float>(v) * ref_from_patch(0, 1);
    const float y_row = begin.y() + static_cast<float>(v) * ref_from_patch(1, 1);
    for (std::size_t u = 0; u < kRim; ++u) {
      x[v * kRim + u] = x_row + static_cast<float>(u) * ref_from_patch(0, 0);
      y[v * kRim + u] = y_row + static_cast<float>(u) * ref_from_patch(1, 0);
    }
  }
  const auto step = static_cast<std::int32_t>(image.step[0]);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const auto x0 = static_cast<std::int32_t>(x[i]);
    const auto y0 = static_cast<std::int32_t>(y[i]);
    offset[i] = y0 * step + x0;
    x[i] -= static_cast<float>(x0);
    y[i] -= static_cast<float>(y0);
  }
  std::array<std::uint32_t, kSamples> four;
  const uchar* pixels = image.data;
  for (std::size_t i = 0; i < kSamples; ++i) {
    std::uint16_t upper = 0;
    std::uint16_t lower = 0;
    std::memcpy(&upper, pixels + offset[i], sizeof(upper));
    std::memcpy(&lower, pixels + offset[i] + step, sizeof(lower));
    four[i] = upper | static_cast<std::uint32_t>(lower) << 16;
  }
  const auto grey = [&](std::size_t i, int shift) {
    return static_cast<float>(static_cast<std::int32_t>(four[i] >> shift & 255U));
  };
  for (std::size_t i = 0; i < kSamples; ++i) {
    const float top = grey(i, 0) + x[i] * (grey(i, 8) - grey(i, 0));
    const float bottom = grey(i, 16) + x[i] * (grey(i, 24) - grey(i, 16));
    rim[i] = top + y[i] * (bottom - top);
  }
  return true;
}

/// Eight neighbours of a patch's row, summed apart, so that vectors of any width give the same
/// bits.
using Lanes = float __attribute__((vector_size(32)));
static_assert(kPatchSide == 8);

inline void load(const float* values, Lanes& lanes) { std::memcpy(&lanes, values, sizeof(lanes)); }

inline float total(const Lanes& lanes) {
  const float even = (lanes[0] + lanes[4]) + (lanes[2] + lanes[6]);
  const float odd = (lanes[1] + lanes[5]) + (lanes[3] + lanes[7]);
  return even + odd;
}

struct Comparison {
  float correlation = 0.0F;
  Eigen::Vector2f gradient;  ///< sum of template gradient times difference
};

PLANECAST_VECTOR_CLONES
Comparison compare(const PatchTemplate& patch, const PatchValues& current) {
  Lanes sum = {}, grey, value, grad_x, grad_y;
  for (int i = 0; i < kPatchArea; i += kPatchSide) {
    load(current.data() + i, grey);
    sum += grey;
  }
  const float mean = total(sum) / kPatchArea;
  Lanes squares = {}, by_value = {}, by_x = {}, by_y = {};
  for (int i = 0; i < kPatchArea; i += kPatchSide) {
    load(current.data() + i, grey);
    load(patch.value.data() + i, value);
    load(patch.grad_x.data() + i, grad_x);
    load(patch.grad_y.data() + i, grad_y);
    const Lanes centred = grey - mean;
    squares += centred * centred;
    by_value += centred * value;
    by_x += centred * grad_x;
    by_y += centred * grad_y;
  }
  const float norm = std::sqrt(total(squares));
  if (norm < 1e-3F) return {0.0F, Eigen::Vector2f::Zero()};
  Comparison result;
  result.correlation = total(by_value) / (norm * patch.norm);
  result.gradient =
      patch.norm / norm * Eigen::Vector2f(total(by_x), total(by_y)) - patch.value_by_gradient;
  return result;
}

}  // namespace

std::optional<PatchSamples> sample_patch(const cv::Mat& image, const Eigen::Vector2f& centre,
                                         const Eigen::Matrix2f& ref_from_patch) {
  PatchSamples samples;
  if (!sample_with_rim(image, centre, ref_from_patch, samples)) return std::nullopt;
  return samples;
}

std::optional<PatchTemplate> make_template(const cv::Mat& image, const Eigen::Vector2f& centre,
                                           const Eigen::Matrix2f& ref_from_patch) {
  const std::optional<PatchSamples> samples = sample_patch(image, centre, ref_from_patch);
  return samples ? make_template(*samples) : std::nullopt;
}

std::optional<PatchTemplate> make_template(const PatchSamples& rim) {
  PatchTemplate patch;
  for (int v = 0; v < kPatchSide; ++v) {
    for (int u = 0; u < kPatchSide; ++u) {
      const int i = v * kPatchSide + u;
      const auto r = static_cast<std::size_t>((v + 1) * kRim + u + 1);
      patch.value[i] = rim[r];
      patch.grad_x[i] = 0.5F * (rim[r + 1] - rim[r - 1]);
      patch.grad_y[i] = 0.5F * (rim[r + kRim] - rim[r - kRim]);
    }
  }
  patch.value -= patch.value.mean();
  patch.grad_x -= patch.grad_x.mean();
  patch.grad_y -= patch.grad_y.mean();
  const float xx = patch.grad_x.square().sum();
  const float yy = patch.grad_y.square().sum();
  const float xy = (patch.grad_x * patch.grad_y).sum();
  const float smaller = 0.5F * (xx + yy) - std::sqrt(0.25F * (xx - yy) * (xx - yy) + xy * xy);
  if (!(smaller > kMinMoment * kPatchArea)) return std::nullopt;
  patch.norm = std::sqrt(patch.value.square().sum());
  patch.value_by_gradient = {(patch.value * patch.grad_x).sum(),
                             (patch.value * patch.grad_y).sum()};
  Eigen::Matrix2f hessian;
  hessian << xx, xy, xy, yy;
  patch.inverse_hessian = hessian.inverse();
  return patch;
}

QuickTemplate::QuickTemplate(const PatchSamples& samples) {
  PatchValues value;
  for (int v = 0; v < kPatchSide; ++v) {
    for (int u = 0; u < kPatchSide; ++u) {
      value[v * kPatchSide + u] = samples[static_cast<std::size_t>((v + 1) * kRim + u + 1)];
    }
  }
  value -= value.mean();
  // 255 times this, times 64 pixels of 255, still fits 32 bits.
  constexpr float kScale = 64.0F;
  // Makes whole numbers of the range positive, so that cutting off rounds.
  constexpr int kPositive = 1 << 14;
  for (std::size_t i = 0; i < kPatchArea; ++i) {
    const float raised = kScale * value[static_cast<int>(i)] + (kPositive + 0.5F);
    const auto rounded = static_cast<std::int16_t>(static_cast<int>(raised) - kPositive);
    value_[i] = rounded;
    sum_ += rounded;
  }
  norm_ = kScale * std::sqrt(value.square().sum());
}

PLANECAST_VECTOR_CLONES
float QuickTemplate::correlate(const cv::Mat& image, const Eigen::Vector2f& centre) const {
  const int x0 = static_cast<int>(std::floor(centre.x() + kFirst + 0.5F));
  const int y0 = static_cast<int>(std::floor(centre.y() + kFirst + 0.5F));
  if (x0 < 0 || y0 < 0 || x0 + kPatchSide > image.cols || y0 + kPatchSide > image.rows)
    return -1.0F;
  std::array<uchar, kPatchArea> pixels;
  for (int v = 0; v < kPatchSide; ++v) {
    std::memcpy(pixels.data() + v * kPatchSide, image.ptr<uchar>(y0 + v) + x0, kPatchSide);
  }
  int sum = 0;
  int square = 0;
  int product = 0;
  for (std::size_t i = 0; i < kPatchArea; ++i) {
    const std::int16_t grey = pixels[i];
    sum += grey;
    square += grey * grey;
    product += grey * value_[i];
  }
  const int variance = square - sum * sum / kPatchArea;
  if (variance < 1 || !(norm_ > 0.0F)) return -1.0F;
  return static_cast<float>(product - sum_ * sum / kPatchArea) /
         (std::sqrt(static_cast<float>(variance)) * norm_);
}

std::optional<PatchAlignment> align_patch(const PatchTemplate& patch, const cv::Mat& image,
                                          const Eigen::Vector2f& start,
                                          const PatchAlignOptions& options) {
  PatchAlignment alignment;
  alignment.pixel = start;
  PatchValues current;
  for (int i = 0; i < options.iterations; ++i) {
    if (!sample_square<kPatchSide>(image, alignment.pixel, current)) return std::nullopt;
    const Comparison comparison = compare(patch, current);
    alignment.correlation = comparison.correlation;
    const Eigen::Vector2f step = patch.inverse_hessian * comparison.gradient;
    alignment.pixel -= step;
    if (!((alignment.pixel - start).norm() < options.max_shift_px)) return std::nullopt;
    if (step.norm() < options.converged_px) return alignment;
  }
  return std::nullopt;
}

}  // namespace planecast::slam
