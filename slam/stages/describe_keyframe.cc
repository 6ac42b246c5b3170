#include "slam/stages/describe_keyframe.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "slam/features/matching.h"
#include "slam/features/place_points.h"

namespace planecast::slam {
namespace {

/// What the tracker found and what else is found of the landmarks about.
std::vector<PatchMatch> find_landmarks(const Map& map, const Camera& camera,
                                       const PoseEstimate& estimate, const ImageFeatures& image,
                                       const DescribeKeyframeOptions& options) {
  std::vector<char> known(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  // Those that the tracker looked for in vain are not there.
  for (const LandmarkId id : estimate.visible) {
    if (map.landmarks.contains(id)) known[static_cast<std::size_t>(id)] = 1;
  }
  for (const PatchMatch& patch : estimate.patches) {
    known[static_cast<std::size_t>(patch.landmark)] = 1;
  }
  std::vector<LandmarkId> others =
      landmarks_of(map, local_keyframes(map, supporting_landmarks(estimate), options.localise));
  std::erase_if(others, [&](LandmarkId id) { return known[static_cast<std::size_t>(id)] != 0; });
  std::vector<PatchMatch> found = estimate.patches;
  const PatchMatches more =
      match_patches(map, camera, *image.pyramid, estimate.cam_from_world, others, options.patches);
  found.insert(found.end(), more.matches.begin(), more.matches.end());
  return found;
}

}  // namespace

PoseEstimate describe_keyframe(const Map& map, const Camera& camera, const PoseEstimate& estimate,
                               const DescribeKeyframeOptions& options, ImagePreparer& preparer,
                               ImageFeatures& image) {
  const ScaleLevels& levels = options.localise.levels;
  const std::vector<PatchMatch> found = find_landmarks(map, camera, estimate, image, options);
  std::vector<FoundPoint> points;
  points.reserve(found.size());
  for (const PatchMatch& patch : found) {
    const Landmark& landmark = map.landmarks.at(patch.landmark);
    const double distance = (estimate.cam_from_world * landmark.position).norm();
    points.push_back({patch.raw, patch.pixel, predict_octave(landmark, distance, levels)});
  }
  // What the landmarks take need not be detected anew.
  const int limit =
      std::max(options.min_corners, options.keypoints - static_cast<int>(points.size()));
  Features features = preparer.detect(image, limit);
  std::vector<char> taken(features.keypoints.size(), 0);
  const std::vector<int> placed =
      place_points(points, camera, options.snap_px, levels, preparer.extractor(), taken, features);
  std::vector<LandmarkId> matches(features.keypoints.size(), kNone);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed[i] != kNone) matches[static_cast<std::size_t>(placed[i])] = found[i].landmark;
  }
  preparer.add_depth(image, features);
  image.features = std::make_shared<const Features>(std::move(features));
  return optimise_matches(map, camera, *image.features, estimate.cam_from_world, std::move(matches),
                          levels);
}

}  // namespace planecast::slam
