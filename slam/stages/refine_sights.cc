#include "slam/stages/refine_sights.h"

#include <Eigen/Core>
#include <memory>
#include <optional>
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

}  // namespace

RefineSightsResult refine_sights(Map& map, const Camera& camera, const PatchMatchOptions& options) {
  RefineSightsResult result;
  // What was there before is the reference for all, so that the order does not matter.
  std::vector<std::shared_ptr<Features>> changed(static_cast<std::size_t>(map.keyframes.next_id()));
  for (const Landmark& landmark : map.landmarks) {
    if (landmark.observations.size() < 2) continue;
    const Observation* reference = nearest_observation(map, landmark, mean_centre(map, landmark));
    if (reference == nullptr) continue;
    for (const Observation& seen : landmark.observations) {
      const Keyframe& keyframe = map.keyframes.at(seen.keyframe);
      if (seen.keyframe == reference->keyframe || keyframe.pyramid == nullptr) continue;
      const auto k = static_cast<std::size_t>(seen.keypoint);
      const std::optional<PatchMatch> match =
          match_patch(map, camera, *keyframe.pyramid, keyframe.cam_from_world, landmark, *reference,
                      keyframe.features->keypoints[k].raw, options);
      if (!match) {
        ++result.kept;
        continue;
      }
      std::shared_ptr<Features>& features = changed[static_cast<std::size_t>(keyframe.id)];
      if (features == nullptr) features = std::make_shared<Features>(*keyframe.features);
      features->keypoints[k].raw = match->raw;
      features->keypoints[k].pixel = match->pixel.cast<float>();
      ++result.refined;
    }
  }
  for (KeyframeId id = 0; id < map.keyframes.next_id(); ++id) {
    std::shared_ptr<Features>& features = changed[static_cast<std::size_t>(id)];
    if (features == nullptr) continue;
    features->build_grid(camera.width, camera.height);
    map.keyframes.at(id).features = std::move(features);
  }
  return result;
}

}  // namespace planecast::slam
