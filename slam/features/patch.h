#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

namespace planecast::slam {

inline constexpr int kPatchSide = 8;
inline constexpr int kPatchArea = kPatchSide * kPatchSide;
using PatchValues = Eigen::Array<float, kPatchArea, 1>;  ///< row by row

/// What a small piece of a surface looks like, ready to be found in another image by inverse
/// compositional Lucas-Kanade over a translation (Baker and Matthews 2004). Mean and contrast of
/// the patch do not count, so that exposure may change.
struct PatchTemplate {
  PatchValues value;   ///< zero mean
  PatchValues grad_x;  ///< zero mean, grey values per pixel
  PatchValues grad_y;
  float norm = 0.0F;  ///< root of the sum of squares of `value`
  Eigen::Vector2f value_by_gradient;
  Eigen::Matrix2f inverse_hessian;
};

inline constexpr int kSampledSide = kPatchSide + 2;  ///< with one sample around it, for gradients
/// Grey values of a patch and what is around it, row by row.
using PatchSamples = std::array<float, kSampledSide * kSampledSide>;

/// Samples a patch: its pixel d (from the centre) is taken from `image` at
/// `centre + ref_from_patch * d`. Nothing if it reaches beyond the image.
std::optional<PatchSamples> sample_patch(const cv::Mat& image, const Eigen::Vector2f& centre,
                                         const Eigen::Matrix2f& ref_from_patch);

/// Nothing if there is too little texture to fix both coordinates.
std::optional<PatchTemplate> make_template(const PatchSamples& samples);

/// The same of a patch that is sampled by sample_patch.
std::optional<PatchTemplate> make_template(const cv::Mat& image, const Eigen::Vector2f& centre,
                                           const Eigen::Matrix2f& ref_from_patch);

/// A template for many quick looks, in whole numbers.
class QuickTemplate {
 public:
  explicit QuickTemplate(const PatchSamples& samples);
  /// Zero-mean normalised correlation with the image, -1..1, at the whole pixels nearest to a
  /// place: half a pixel off at most. -1 where it reaches beyond the image or either is flat.
  float correlate(const cv::Mat& image, const Eigen::Vector2f& centre) const;

 private:
  std::array<std::int16_t, kPatchArea> value_;
  int sum_ = 0;  ///< what rounding leaves of its zero mean
  float norm_ = 0.0F;
};

struct PatchAlignOptions {
  int iterations = 10;
  float converged_px = 0.02F;
  float max_shift_px = 4.0F;  ///< from where it starts; more is a failure
};

struct PatchAlignment {
  Eigen::Vector2f pixel;     ///< of the template's centre
  float correlation = 0.0F;  ///< zero-mean normalised, -1..1
};

/// Finds the template in `image` (8-bit grey) near `start`. Nothing if it leaves the image, moves
/// too far or does not settle.
std::optional<PatchAlignment> align_patch(const PatchTemplate& patch, const cv::Mat& image,
                                          const Eigen::Vector2f& start,
                                          const PatchAlignOptions& options = {});

}  // namespace planecast::slam
