#pragma once

#include <cstdint>
#include <optional>

#include "slam/stages/localise.h"

namespace planecast::slam {

struct RelocaliseOptions {
  int min_matches = 15;  ///< descriptor matches with a keyframe to try it
  int min_inliers = 50;  ///< after projection matching [K]
  int candidates = 5;    ///< keyframes tried, most matches first
  double ratio = 0.75;
  std::uint64_t seed = 1;
  LocaliseOptions localise;
};

/// Finds the image in the map without a prior pose: descriptor matches with the keyframes'
/// landmarks, PnP, then projection matching.
std::optional<PoseEstimate> relocalise(const Map& map, const Camera& camera,
                                       const Features& features, const RelocaliseOptions& options);

/// The same against one keyframe, accepting `min_inliers` supports of the PnP itself.
std::optional<PoseEstimate> match_keyframe(const Map& map, const Camera& camera,
                                           const Features& features, KeyframeId keyframe,
                                           const RelocaliseOptions& options);

}  // namespace planecast::slam
