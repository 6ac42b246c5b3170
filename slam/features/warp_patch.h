#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/data/frame.h"
#include "slam/features/patch.h"

namespace planecast::slam {

/// A keypoint's surroundings as they should look in another image, at one of its half-scale levels.
template <typename Looks>
struct Warped {
  Looks looks;
  int level = 0;  ///< of the other image
};
using WarpedSamples = Warped<PatchSamples>;
using WarpedPatch = Warped<PatchTemplate>;

/// `image_from_ref`: derivative of the raw pixel in the image by that in the reference (see
/// change_of_view). The level is chosen so that the patch covers what the keypoint's octave does,
/// or `coarser` levels above that. Nothing where the scale changes more than three-fold or the
/// patch reaches beyond the reference.
std::optional<WarpedSamples> warp_samples(const ImagePyramid& reference, const Keypoint& keypoint,
                                          const Eigen::Matrix2d& image_from_ref,
                                          const ImagePyramid& image, const ScaleLevels& levels,
                                          int coarser = 0);

/// The same, ready for alignment; nothing also where there is too little texture for it.
std::optional<WarpedPatch> warp_patch(const ImagePyramid& reference, const Keypoint& keypoint,
                                      const Eigen::Matrix2d& image_from_ref,
                                      const ImagePyramid& image, const ScaleLevels& levels,
                                      int coarser = 0);

}  // namespace planecast::slam
