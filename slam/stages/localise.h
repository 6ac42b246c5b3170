#pragma once

#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/stages/initialise.h"
#include "slam/stages/match_patches.h"

namespace planecast::slam {

/// Defaults [K].
struct LocaliseOptions {
  int max_local_keyframes = 80;
  int neighbours_each = 10;
  double local_map_ratio = 0.8;  ///< best against second best descriptor
  ScaleLevels levels;
};

/// A pose with the landmarks that support it.
struct PoseEstimate {
  Pose cam_from_world = Pose::Identity();
  std::vector<LandmarkId> matches;  ///< per keypoint, inliers only; empty without keypoints
  std::vector<PatchMatch> patches;  ///< inliers found by their looks, without keypoints
  int inliers = 0;
  double rms = 0.0;  ///< normalised
  Eigen::Matrix<double, 6, 6> information =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< as in PoseResult
  std::vector<LandmarkId> visible;          ///< expected in the image, matched or not, ascending
};

/// The landmarks that support it, in the order of the keypoints or patches.
std::vector<LandmarkId> supporting_landmarks(const PoseEstimate& estimate);

/// Optimises the pose over `matches` (per keypoint) and clears the outliers.
PoseEstimate optimise_matches(const Map& map, const Camera& camera, const Features& features,
                              const Pose& prior_cam_from_world, std::vector<LandmarkId> matches,
                              const ScaleLevels& levels);

struct LocaliseByPatchesOptions {
  PatchMatchOptions match;
  int min_inliers = 30;
  double min_share = 0.3;    ///< of the landmarks looked for
  double max_depth_m = 8.0;  ///< depth beyond it is not used
};

/// Finds `candidates` by their looks from a nearly known pose and optimises the pose over them,
/// with depth where the image has it. Nothing with too few inliers.
std::optional<PoseEstimate> localise_by_patches(const Map& map, const Camera& camera,
                                                const ImageFeatures& image,
                                                const Pose& guess_cam_from_world,
                                                const std::vector<LandmarkId>& candidates,
                                                const LocaliseByPatchesOptions& options);

/// The keyframes about landmarks in view: those that observe most of them, most first, and their
/// neighbours.
std::vector<KeyframeId> local_keyframes(const Map& map, const std::vector<LandmarkId>& in_view,
                                        const LocaliseOptions& options);

/// The landmarks that `keyframes` observe, each once, in the order of the keyframes.
std::vector<LandmarkId> landmarks_of(const Map& map, const std::vector<KeyframeId>& keyframes);

/// Searches the landmarks of `keyframes` in the image from a prior pose and optimises over the old
/// and new matches. `widen` multiplies the search radius.
PoseEstimate search_local_map(const Map& map, const Camera& camera, const Features& features,
                              const PoseEstimate& prior, const std::vector<KeyframeId>& keyframes,
                              double widen, const LocaliseOptions& options);

}  // namespace planecast::slam
