#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "slam/features/vocabulary.h"
#include "slam/stages/localise.h"

namespace planecast::slam {

struct RelocaliseOptions {
  int min_matches = 15;  ///< descriptor matches with a keyframe to try it
  int min_inliers = 50;  ///< after projection matching [K]
  int alike = 12;  ///< keyframes whose landmarks are matched: those that look most like the image
  int candidates = 5;  ///< of them tried, most matches first
  double ratio = 0.75;
  std::uint64_t seed = 1;
  std::shared_ptr<const Vocabulary> vocabulary;  ///< null: every keyframe's landmarks are matched
  LocaliseOptions localise;
};

/// Finds the image in the map without a prior pose: the keyframes that look like it by the
/// vocabulary, descriptor matches with their landmarks, PnP, then projection matching.
std::optional<PoseEstimate> relocalise(const Map& map, const Camera& camera,
                                       const Features& features, const RelocaliseOptions& options);

/// The same against one keyframe, accepting `min_inliers` supports of the PnP itself.
std::optional<PoseEstimate> match_keyframe(const Map& map, const Camera& camera,
                                           const Features& features, KeyframeId keyframe,
                                           const RelocaliseOptions& options);

}  // namespace planecast::slam
