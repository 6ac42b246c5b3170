#include "slam/features/warp_patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "slam/features/pyramid.h"

namespace planecast::slam {

std::optional<WarpedSamples> warp_samples(const ImagePyramid& reference, const Keypoint& keypoint,
                                          const Eigen::Matrix2d& image_from_ref,
                                          const ImagePyramid& image, const ScaleLevels& levels,
                                          int coarser) {
  constexpr double kMaxScale = 3.0;
  const double scale = std::sqrt(std::abs(image_from_ref.determinant()));
  if (!(scale > 1.0 / kMaxScale && scale < kMaxScale)) return std::nullopt;
  const int octave_level = static_cast<int>(std::lround(std::log2(levels.scale(keypoint.octave))));
  const int grown = static_cast<int>(std::lround(std::log2(scale)));
  const int last = static_cast<int>(std::min(image.levels.size(), reference.levels.size())) - 1;
  WarpedSamples warped;
  warped.level = std::clamp(octave_level + grown + coarser, 0, last);
  const int reference_level = std::clamp(warped.level - grown, 0, last);
  const Eigen::Matrix2d ref_from_patch =
      image_from_ref.inverse() * std::ldexp(1.0, warped.level - reference_level);
  const auto looks =
      sample_patch(reference.levels[static_cast<std::size_t>(reference_level)],
                   at_level(keypoint.raw, reference_level), ref_from_patch.cast<float>());
  if (!looks) return std::nullopt;
  warped.looks = *looks;
  return warped;
}

std::optional<WarpedPatch> warp_patch(const ImagePyramid& reference, const Keypoint& keypoint,
                                      const Eigen::Matrix2d& image_from_ref,
                                      const ImagePyramid& image, const ScaleLevels& levels,
                                      int coarser) {
  const std::optional<WarpedSamples> warped =
      warp_samples(reference, keypoint, image_from_ref, image, levels, coarser);
  if (!warped) return std::nullopt;
  const std::optional<PatchTemplate> looks = make_template(warped->looks);
  if (!looks) return std::nullopt;
  return WarpedPatch{*looks, warped->level};
}

}  // namespace planecast::slam
