#include "slam/stages/relocalise.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "slam/features/matching.h"
#include "slam/geometry/pnp.h"
#include "slam/stages/recognise_places.h"

namespace planecast::slam {
namespace {

/// Per keypoint of the image the keyframe's landmark that looks like it.
std::vector<LandmarkId> match_descriptors(const Keyframe& keyframe, const Features& features,
                                          double ratio, int& count) {
  std::vector<char> use(keyframe.landmarks.size());
  for (std::size_t k = 0; k < use.size(); ++k) use[k] = keyframe.landmarks[k] != kNone ? 1 : 0;
  std::vector<LandmarkId> matches(features.keypoints.size(), kNone);
  const auto pairs = match_brute_force(*keyframe.features, use, features, kStrictDistance, ratio);
  for (const auto& [from, to] : pairs) {
    matches[static_cast<std::size_t>(to)] = keyframe.landmarks[static_cast<std::size_t>(from)];
  }
  count = static_cast<int>(pairs.size());
  return matches;
}

std::optional<PoseEstimate> pose_from_matches(const Map& map, const Camera& camera,
                                              const Features& features,
                                              std::vector<LandmarkId> matches,
                                              const RelocaliseOptions& options) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> sigmas;
  std::vector<std::size_t> keypoint_of;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (matches[k] == kNone) continue;
    points.push_back(map.landmarks.at(matches[k]).position);
    pixels.push_back(features.keypoints[k].pixel.cast<double>());
    sigmas.push_back(options.localise.levels.sigma_px(features.keypoints[k].octave));
    keypoint_of.push_back(k);
  }
  PnpOptions pnp;
  pnp.seed = options.seed;
  const std::optional<PnpResult> pose = solve_pnp(camera, points, pixels, sigmas, pnp);
  if (!pose) return std::nullopt;
  for (std::size_t i = 0; i < keypoint_of.size(); ++i) {
    if (pose->inlier[i] == 0) matches[keypoint_of[i]] = kNone;
  }
  return optimise_matches(map, camera, features, pose->cam_from_world, std::move(matches),
                          options.localise.levels);
}

PoseEstimate widen_to_local_map(const Map& map, const Camera& camera, const Features& features,
                                const PoseEstimate& rough, const RelocaliseOptions& options) {
  const auto keyframes = local_keyframes(map, rough.matches, options.localise);
  const PoseEstimate wide =
      search_local_map(map, camera, features, rough, keyframes, 3.0, options.localise);
  return search_local_map(map, camera, features, wide, keyframes, 1.0, options.localise);
}

/// The keyframes that may show what the image shows.
std::vector<KeyframeId> keyframes_alike(const Map& map, const Features& features,
                                        const RelocaliseOptions& options) {
  std::vector<KeyframeId> alike;
  if (options.vocabulary == nullptr) {
    for (const Keyframe& keyframe : map.keyframes) alike.push_back(keyframe.id);
    return alike;
  }
  const BagOfWords words = options.vocabulary->describe(features.descriptors);
  for (const Place& place :
       best_places(score_places(map, words), static_cast<std::size_t>(options.alike))) {
    alike.push_back(place.keyframe);
  }
  return alike;
}

}  // namespace

std::optional<PoseEstimate> match_keyframe(const Map& map, const Camera& camera,
                                           const Features& features, KeyframeId keyframe,
                                           const RelocaliseOptions& options) {
  int count = 0;
  std::vector<LandmarkId> matches =
      match_descriptors(map.keyframes.at(keyframe), features, options.ratio, count);
  if (count < options.min_matches) return std::nullopt;
  return pose_from_matches(map, camera, features, std::move(matches), options);
}

std::optional<PoseEstimate> relocalise(const Map& map, const Camera& camera,
                                       const Features& features, const RelocaliseOptions& options) {
  struct Candidate {
    int count;
    std::vector<LandmarkId> matches;
  };
  std::vector<Candidate> candidates;
  for (const KeyframeId id : keyframes_alike(map, features, options)) {
    Candidate candidate;
    candidate.matches =
        match_descriptors(map.keyframes.at(id), features, options.ratio, candidate.count);
    if (candidate.count >= options.min_matches) candidates.push_back(std::move(candidate));
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.count > b.count; });
  if (candidates.size() > static_cast<std::size_t>(options.candidates)) {
    candidates.resize(static_cast<std::size_t>(options.candidates));
  }
  for (Candidate& candidate : candidates) {
    const std::optional<PoseEstimate> rough =
        pose_from_matches(map, camera, features, std::move(candidate.matches), options);
    if (!rough || rough->inliers < 10) continue;
    PoseEstimate estimate = widen_to_local_map(map, camera, features, *rough, options);
    if (estimate.inliers >= options.min_inliers) return estimate;
  }
  return std::nullopt;
}

}  // namespace planecast::slam
