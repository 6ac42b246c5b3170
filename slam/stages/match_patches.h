#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/data/map.h"
#include "slam/features/patch.h"

namespace planecast::slam {

inline constexpr double kPatchSigmaPx = 0.6;

/// Where a landmark was found in an image by its looks.
struct PatchMatch {
  LandmarkId landmark = kNone;
  Eigen::Vector2f raw;    ///< raw pixel
  Eigen::Vector2d pixel;  ///< undistorted pixel
  int level = 0;          ///< half-scale level at which it was found

  /// Standard deviation of its position: half a pixel of its level, with the error of the
  /// landmark's own position.
  double sigma_px() const { return kPatchSigmaPx * (1 << level); }
};

struct PatchMatchOptions {
  int max_matches = 300;  ///< spread over the image
  int cell_px = 32;       ///< one landmark a cell first; at 640 px image width, scaled with it
  int rounds = 3;         ///< so many landmarks of a cell are tried at most
  double min_correlation = 0.8;
  PatchAlignOptions align;
  ScaleLevels levels;
};

struct PatchMatches {
  std::vector<PatchMatch> matches;
  std::vector<LandmarkId> tried;  ///< in the image by the guessed pose, and looked for; ascending
};

/// Looks for landmarks in an image whose pose is nearly known (within `align.max_shift_px` at each
/// landmark's level): each one's surroundings in the observing keyframe nearest to the camera,
/// warped by the change of view, are aligned to the image to a fraction of a pixel. Precise
/// landmarks (with many observations) are preferred, one in each cell of the image, until there are
/// enough. `candidates`: ids of living landmarks, each at most once. Keyframes without an image
/// pyramid are passed over.
PatchMatches match_patches(const Map& map, const Camera& camera, const ImagePyramid& image,
                           const Pose& guess_cam_from_world,
                           const std::vector<LandmarkId>& candidates,
                           const PatchMatchOptions& options);

/// The landmark's observation in the keyframe nearest to `centre_world` among those that have their
/// image; null if there is none.
const Observation* nearest_observation(const Map& map, const Landmark& landmark,
                                       const Eigen::Vector3d& centre_world);

/// The same for one landmark against one of its observations, starting at `start_raw`.
std::optional<PatchMatch> match_patch(const Map& map, const Camera& camera,
                                      const ImagePyramid& image, const Pose& cam_from_world,
                                      const Landmark& landmark, const Observation& seen,
                                      const Eigen::Vector2f& start_raw,
                                      const PatchMatchOptions& options);

}  // namespace planecast::slam
