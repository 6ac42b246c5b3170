#include "slam/stages/refine_sights.h"

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace planecast::slam {
namespace {

Eigen::Vector3d mean_centre(const Map& map, const Landmark& landmark) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Observation& seen : landmark.observations) {
    sum += map.keyframes.at(seen.keyframe).centre_world();
  }
  return sum / static_cast<double>(landmark.observations.size());
}

/// New positions of keypoints, kept aside so that what is aligned in one round has the same
/// references whatever the order.
class MovedKeypoints {
 public:
  explicit MovedKeypoints(const Map& map)
      : features_(static_cast<std::size_t>(map.keyframes.next_id())) {}

  void move(const Keyframe& keyframe, int keypoint, const PatchMatch& match) {
    std::shared_ptr<Features>& features = features_[static_cast<std::size_t>(keyframe.id)];
    if (features == nullptr) features = std::make_shared<Features>(*keyframe.features);
    Keypoint& moved = features->keypoints[static_cast<std::size_t>(keypoint)];
    moved.raw = match.raw;
    moved.pixel = match.pixel.cast<float>();
  }

  void apply(const Camera& camera, Map& map) {
    for (KeyframeId id = 0; id < map.keyframes.next_id(); ++id) {
      std::shared_ptr<Features>& features = features_[static_cast<std::size_t>(id)];
      if (features == nullptr) continue;
      features->build_grid(camera.width, camera.height);
      map.keyframes.at(id).features = std::exchange(features, nullptr);
    }
  }

 private:
  std::vector<std::shared_ptr<Features>> features_;  ///< by keyframe; null: unchanged
};

/// A sight to align, and the one that it is to look like.
struct SightPair {
  LandmarkId landmark = kNone;
  Observation seen;
  Observation reference;
};

/// Aligns the sights with their references. Returns those that do not look like them.
std::vector<SightPair> align(const std::vector<SightPair>& pairs, const Camera& camera,
                             const PatchMatchOptions& options, Map& map) {
  std::vector<SightPair> unlike;
  MovedKeypoints moved(map);
  for (const SightPair& pair : pairs) {
    const Keyframe& keyframe = map.keyframes.at(pair.seen.keyframe);
    const auto k = static_cast<std::size_t>(pair.seen.keypoint);
    const std::optional<PatchMatch> match = match_patch(
        map, camera, *keyframe.pyramid, keyframe.cam_from_world, map.landmarks.at(pair.landmark),
        pair.reference, keyframe.features->keypoints[k].raw, options);
    if (match) {
      moved.move(keyframe, pair.seen.keypoint, *match);
    } else {
      unlike.push_back(pair);
    }
  }
  moved.apply(camera, map);
  return unlike;
}

/// Every sight of a landmark but the one in the middle, with that.
std::vector<SightPair> pair_with_middle(const Map& map) {
  std::vector<SightPair> pairs;
  for (const Landmark& landmark : map.landmarks) {
    if (landmark.observations.size() < 2) continue;
    const Observation* reference = nearest_observation(map, landmark, mean_centre(map, landmark));
    if (reference == nullptr) continue;
    for (const Observation& seen : landmark.observations) {
      if (seen.keyframe == reference->keyframe) continue;
      if (map.keyframes.at(seen.keyframe).pyramid == nullptr) continue;
      pairs.push_back({landmark.id, seen, *reference});
    }
  }
  return pairs;
}

/// The sights (by landmark) once more, each with the nearest one of its landmark that is not among
/// them.
std::vector<SightPair> pair_with_nearest(const Map& map, const std::vector<SightPair>& unlike) {
  std::vector<SightPair> pairs;
  for (auto begin = unlike.begin(); begin != unlike.end();) {
    const auto end = std::find_if(
        begin, unlike.end(), [&](const SightPair& p) { return p.landmark != begin->landmark; });
    Landmark alike = map.landmarks.at(begin->landmark);
    std::erase_if(alike.observations, [&](const Observation& seen) {
      return std::any_of(begin, end,
                         [&](const SightPair& p) { return p.seen.keyframe == seen.keyframe; });
    });
    for (; begin != end; ++begin) {
      const Eigen::Vector3d centre = map.keyframes.at(begin->seen.keyframe).centre_world();
      // There is one at least, what they were aligned with before.
      pairs.push_back({alike.id, begin->seen, *nearest_observation(map, alike, centre)});
    }
  }
  return pairs;
}

}  // namespace

RefineSightsResult refine_sights(Map& map, const Camera& camera, const PatchMatchOptions& options) {
  RefineSightsResult result;
  const std::vector<SightPair> pairs = pair_with_middle(map);
  std::vector<SightPair> unlike = align(pairs, camera, options, map);
  unlike = align(pair_with_nearest(map, unlike), camera, options, map);
  for (const SightPair& pair : unlike) {
    if (!map.landmarks.contains(pair.landmark)) continue;
    map.remove_observation(pair.landmark, pair.seen.keyframe);
  }
  result.removed = static_cast<int>(unlike.size());
  result.refined = static_cast<int>(pairs.size()) - result.removed;
  return result;
}

}  // namespace planecast::slam
