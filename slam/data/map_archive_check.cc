#include <algorithm>
#include <utility>

#include "slam/data/map_archive.h"

namespace planecast::slam {

bool MapArchive::history_is_sound(const Map& map) {
  for (const auto& [a, b] : map.loop_edges) {
    if (!map.keyframes.contains(a) || !map.keyframes.contains(b)) return false;
  }
  int previous = -1;
  for (const Map::ErasedKeyframe& erased : map.erased_keyframes_) {
    if (erased.id <= previous || map.keyframes.contains(erased.id)) return false;
    // Ancestors are older, so that every chain of them ends.
    if (erased.parent >= erased.id || erased.parent < kNone) return false;
    if (!(erased.unit_per_parent > 0.0)) return false;
    previous = erased.id;
  }
  if (!std::is_sorted(map.replaced_.begin(), map.replaced_.end())) return false;
  for (const auto& [from, to] : map.replaced_) {
    LandmarkId id = from;
    for (std::size_t steps = 0; !map.landmarks.contains(id); ++steps) {
      const auto place =
          std::lower_bound(map.replaced_.begin(), map.replaced_.end(), std::pair(id, kNone));
      if (place == map.replaced_.end() || place->first != id) break;
      if (steps > map.replaced_.size()) return false;
      id = place->second;
    }
  }
  return true;
}

bool MapArchive::is_sound(const Map& map) {
  std::size_t held = 0;
  for (const Keyframe& keyframe : map.keyframes) {
    const std::size_t size = keyframe.features->keypoints.size();
    if (keyframe.landmarks.size() != size || keyframe.labels.size() != size) return false;
    if (!(keyframe.unit > 0.0) || keyframe.parent >= keyframe.id) return false;
    if (keyframe.parent != kNone && !map.keyframes.contains(keyframe.parent)) return false;
    for (const LandmarkId id : keyframe.landmarks) {
      if (id == kNone) continue;
      if (!map.landmarks.contains(id)) return false;
      ++held;
    }
  }
  std::size_t observed = 0;
  for (const Landmark& landmark : map.landmarks) {
    KeyframeId previous = kNone;
    for (const Observation& observation : landmark.observations) {
      const Keyframe* keyframe = map.keyframes.find(observation.keyframe);
      if (keyframe == nullptr || observation.keyframe <= previous) return false;
      const auto keypoint = static_cast<std::size_t>(observation.keypoint);
      if (observation.keypoint < 0 || keypoint >= keyframe->landmarks.size() ||
          keyframe->landmarks[keypoint] != landmark.id) {
        return false;
      }
      previous = observation.keyframe;
      ++observed;
    }
    if (landmark.observations.empty() || landmark.visible < 1) return false;
  }
  return held == observed && history_is_sound(map);
}

}  // namespace planecast::slam
