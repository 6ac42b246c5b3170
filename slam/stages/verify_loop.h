#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/geometry/sim3.h"

namespace planecast::slam {

/// Defaults [K]; windows are for 640 px image width and scale with it.
struct VerifyOptions {
  bool with_scale = true;   ///< mono; RGB-D closes rigidly
  double ratio = 0.75;      ///< best against second best descriptor
  int min_inliers = 20;     ///< landmarks of both keyframes that agree
  int min_matches = 40;     ///< landmarks of the loop's whole neighbourhood found in the keyframe
  double window_px = 10.0;  ///< at octave 0
  std::uint64_t seed = 1;
  ScaleLevels levels;
};

/// A keyframe that shows the place of a much older one.
struct LoopMatch {
  KeyframeId keyframe = kNone;
  KeyframeId loop_keyframe = kNone;  ///< the older one
  Similarity cam_from_loop_cam;      ///< between their camera frames, each in map units
  std::vector<LandmarkId> matches;   ///< per keypoint of `keyframe`, on the older side
  int count = 0;                     ///< of them
};

/// Whether geometry confirms that the two keyframes show one place: descriptor matches of their
/// landmarks, Sim3 or SE3 by RANSAC, projection search both ways, refinement, and landmarks of the
/// older keyframe's neighbourhood searched in the newer one.
std::optional<LoopMatch> verify_loop(const Map& map, const Camera& camera, KeyframeId keyframe,
                                     KeyframeId candidate, const VerifyOptions& options);

/// Landmarks seen by a keyframe or one covisible with it, ascending.
std::vector<LandmarkId> landmarks_around(const Map& map, KeyframeId keyframe);

}  // namespace planecast::slam
