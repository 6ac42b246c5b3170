#include "slam/stages/verify_loop.h"

#include <algorithm>
#include <utility>

#include "slam/features/matching.h"
#include "slam/geometry/random.h"
#include "slam/optimize/similarity.h"

namespace planecast::slam {
namespace {

/// Keypoints of both keyframes, each with a landmark, that may be the same thing.
using KeypointPairs = std::vector<std::pair<int, int>>;

LandmarkId landmark_at(const Keyframe& keyframe, int keypoint) {
  return keyframe.landmarks[static_cast<std::size_t>(keypoint)];
}

KeypointPairs match_by_looks(const Keyframe& a, const Keyframe& b, double ratio) {
  std::vector<char> use(a.landmarks.size());
  for (std::size_t k = 0; k < use.size(); ++k) use[k] = a.landmarks[k] != kNone ? 1 : 0;
  KeypointPairs pairs = match_brute_force(*a.features, use, *b.features, kStrictDistance, ratio);
  std::erase_if(pairs, [&](const auto& pair) { return landmark_at(b, pair.second) == kNone; });
  return pairs;
}

std::vector<SimilarityPair> geometry_of(const Map& map, const Keyframe& a, const Keyframe& b,
                                        const KeypointPairs& pairs, const ScaleLevels& levels) {
  std::vector<SimilarityPair> result;
  result.reserve(pairs.size());
  for (const auto& [in_a, in_b] : pairs) {
    const Keypoint& keypoint_a = a.features->keypoints[static_cast<std::size_t>(in_a)];
    const Keypoint& keypoint_b = b.features->keypoints[static_cast<std::size_t>(in_b)];
    SimilarityPair pair;
    pair.point_a = a.cam_from_world * map.landmarks.at(landmark_at(a, in_a)).position;
    pair.point_b = b.cam_from_world * map.landmarks.at(landmark_at(b, in_b)).position;
    pair.pixel_a = keypoint_a.pixel.cast<double>();
    pair.pixel_b = keypoint_b.pixel.cast<double>();
    pair.sigma_a_px = levels.sigma_px(keypoint_a.octave);
    pair.sigma_b_px = levels.sigma_px(keypoint_b.octave);
    result.push_back(pair);
  }
  return result;
}

/// Per keypoint of `features` the landmark that projects there and looks like it.
std::vector<LandmarkId> find_landmarks(const Map& map, const Camera& camera,
                                       const Features& features, const Pose& cam_from_world,
                                       const std::vector<LandmarkId>& landmarks,
                                       const std::vector<LandmarkId>& taken,
                                       const VerifyOptions& options) {
  const double window_px = options.window_px * std::max(camera.width, camera.height) / 640.0;
  std::vector<Expectation> expectations;
  for (const LandmarkId id : landmarks) {
    if (id == kNone || std::find(taken.begin(), taken.end(), id) != taken.end()) continue;
    Expectation expectation;
    if (!expect_landmark(map.landmarks.at(id), camera, cam_from_world, options.levels,
                         expectation)) {
      continue;
    }
    expectation.radius_px = window_px * options.levels.scale(expectation.max_octave);
    expectations.push_back(expectation);
  }
  ExpectationMatchOptions match;
  match.max_distance = kStrictDistance;
  std::vector<LandmarkId> found(features.keypoints.size(), kNone);
  for (const auto& [k, e] : match_expectations(features, expectations, taken, match)) {
    found[static_cast<std::size_t>(k)] = expectations[static_cast<std::size_t>(e)].landmark;
  }
  return found;
}

/// Adds pairs whose landmarks find each other by projection, both ways.
void add_mutual(const Map& map, const Camera& camera, const Keyframe& a, const Keyframe& b,
                const Similarity& a_from_b, const VerifyOptions& options, KeypointPairs& pairs) {
  // Each camera in the other's units, so that the landmarks' ranges of distance hold.
  const Pose a_pose = pose_in_source_units(a_from_b * similarity_from_pose(b.cam_from_world));
  const Pose b_pose =
      pose_in_source_units(a_from_b.inverse() * similarity_from_pose(a.cam_from_world));
  const std::vector<LandmarkId> in_a =
      find_landmarks(map, camera, *a.features, a_pose, b.landmarks, {}, options);
  const std::vector<LandmarkId> in_b =
      find_landmarks(map, camera, *b.features, b_pose, a.landmarks, {}, options);
  std::vector<char> used_a(in_a.size(), 0);
  std::vector<char> used_b(in_b.size(), 0);
  for (const auto& [k, j] : pairs) {
    used_a[static_cast<std::size_t>(k)] = 1;
    used_b[static_cast<std::size_t>(j)] = 1;
  }
  for (std::size_t j = 0; j < in_b.size(); ++j) {
    if (in_b[j] == kNone || b.landmarks[j] == kNone || used_b[j] != 0) continue;
    const auto k = static_cast<std::size_t>(
        std::find(a.landmarks.begin(), a.landmarks.end(), in_b[j]) - a.landmarks.begin());
    if (used_a[k] != 0 || in_a[k] != b.landmarks[j]) continue;
    pairs.emplace_back(static_cast<int>(k), static_cast<int>(j));
  }
  std::sort(pairs.begin(), pairs.end());
}

KeypointPairs only_inliers(const KeypointPairs& pairs, const std::vector<char>& inlier) {
  KeypointPairs kept;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (inlier[i] != 0) kept.push_back(pairs[i]);
  }
  return kept;
}

}  // namespace

std::vector<LandmarkId> landmarks_around(const Map& map, KeyframeId keyframe) {
  std::vector<LandmarkId> around = map.keyframes.at(keyframe).landmarks;
  for (const auto& [id, shared] : map.covisible(keyframe)) {
    const std::vector<LandmarkId>& seen = map.keyframes.at(id).landmarks;
    around.insert(around.end(), seen.begin(), seen.end());
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  if (!around.empty() && around.front() == kNone) around.erase(around.begin());
  return around;
}

std::optional<LoopMatch> verify_loop(const Map& map, const Camera& camera, KeyframeId keyframe,
                                     KeyframeId candidate, const VerifyOptions& options) {
  const Keyframe& a = map.keyframes.at(keyframe);
  const Keyframe& b = map.keyframes.at(candidate);
  KeypointPairs pairs = match_by_looks(a, b, options.ratio);
  if (static_cast<int>(pairs.size()) < options.min_inliers) return std::nullopt;

  SimilarityOptions ransac;
  ransac.with_scale = options.with_scale;
  ransac.min_inliers = options.min_inliers;
  ransac.seed = mix_seed(options.seed, static_cast<std::uint64_t>(keyframe) * 65536 +
                                           static_cast<std::uint64_t>(candidate));
  const auto rough =
      solve_similarity(camera, geometry_of(map, a, b, pairs, options.levels), ransac);
  if (!rough) return std::nullopt;
  pairs = only_inliers(pairs, rough->inlier);
  add_mutual(map, camera, a, b, rough->a_from_b, options, pairs);
  SimilarityRefineOptions refine;
  refine.with_scale = options.with_scale;
  const SimilarityResult fine = refine_similarity(
      camera, geometry_of(map, a, b, pairs, options.levels), rough->a_from_b, refine);
  if (fine.num_inliers < options.min_inliers) return std::nullopt;

  LoopMatch match;
  match.keyframe = keyframe;
  match.loop_keyframe = candidate;
  match.cam_from_loop_cam = fine.a_from_b;
  match.matches.assign(a.landmarks.size(), kNone);
  for (const auto& [k, j] : only_inliers(pairs, fine.inlier)) {
    match.matches[static_cast<std::size_t>(k)] = landmark_at(b, j);
  }
  const Pose corrected =
      pose_in_source_units(fine.a_from_b * similarity_from_pose(b.cam_from_world));
  const std::vector<LandmarkId> further =
      find_landmarks(map, camera, *a.features, corrected, landmarks_around(map, candidate),
                     match.matches, options);
  for (std::size_t k = 0; k < further.size(); ++k) {
    if (further[k] != kNone) match.matches[k] = further[k];
  }
  match.count = static_cast<int>(std::count_if(match.matches.begin(), match.matches.end(),
                                               [](LandmarkId id) { return id != kNone; }));
  if (match.count < options.min_matches) return std::nullopt;
  return match;
}

}  // namespace planecast::slam
