#include "slam/stages/map_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "slam/features/matching.h"
#include "slam/geometry/triangulate.h"

namespace planecast::slam {
namespace {

double squared_error_px(const Camera& camera, const Pose& cam_from_world,
                        const Eigen::Vector3d& point_world, const Keypoint& keypoint) {
  const Eigen::Vector3d point_cam = cam_from_world * point_world;
  if (point_cam.z() <= 0.0) return 1e12;
  return (camera.project(point_cam) - keypoint.pixel.cast<double>()).squaredNorm();
}

/// The ratio of distances must agree with the ratio of the octaves.
bool scales_agree(const Keyframe& a, const Keypoint& in_a, const Keyframe& b, const Keypoint& in_b,
                  const Eigen::Vector3d& point, const ScaleLevels& levels) {
  const double distance_a = (point - a.centre_world()).norm();
  const double distance_b = (point - b.centre_world()).norm();
  if (distance_a < 1e-9 || distance_b < 1e-9) return false;
  const double ratio = distance_b / distance_a;
  const double octave_ratio = levels.scale(in_a.octave) / levels.scale(in_b.octave);
  const double slack = 1.5 * levels.factor;
  return ratio * slack > octave_ratio && ratio < octave_ratio * slack;
}

/// Whether enough other keyframes see a landmark.
bool seen_enough(const Landmark& landmark, const PointMappingOptions& options) {
  return static_cast<int>(landmark.observations.size()) > options.redundant_observers;
}

/// Whether enough other keyframes see a landmark at the octave of keypoint `k` or finer.
bool seen_enough_elsewhere(const Map& map, const Keyframe& keyframe, std::size_t k,
                           const PointMappingOptions& options) {
  const Landmark& landmark = map.landmarks.at(keyframe.landmarks[k]);
  if (!seen_enough(landmark, options)) return false;
  const int octave = keyframe.features->keypoints[k].octave;
  int observers = 0;
  for (const Observation& other : landmark.observations) {
    if (other.keyframe == keyframe.id) continue;
    const int other_octave = map.keyframes.at(other.keyframe)
                                 .features->keypoints[static_cast<std::size_t>(other.keypoint)]
                                 .octave;
    observers += other_octave <= octave + 1;
    if (observers >= options.redundant_observers) return true;
  }
  return false;
}

/// Whether nearly all of the keyframe's landmarks are seen enough elsewhere.
bool is_redundant(const Map& map, const Keyframe& keyframe, const PointMappingOptions& options) {
  const std::size_t keypoints = keyframe.landmarks.size();
  const auto total = keypoints - static_cast<std::size_t>(std::count(
                                     keyframe.landmarks.begin(), keyframe.landmarks.end(), kNone));
  const double may_be_needed = (1.0 - options.redundant_share) * static_cast<double>(total);
  const auto few_are_needed = [&](const auto& is_needed) {
    int needed = 0;
    for (std::size_t k = 0; k < keypoints; ++k) {
      if (keyframe.landmarks[k] == kNone || !is_needed(k)) continue;
      if (++needed >= may_be_needed) return false;
    }
    return true;
  };
  // Most keyframes are needed, which mere numbers of observers show; octaves lie far apart in
  // memory.
  return few_are_needed([&](std::size_t k) {
           return !seen_enough(map.landmarks.at(keyframe.landmarks[k]), options);
         }) &&
         few_are_needed(
             [&](std::size_t k) { return !seen_enough_elsewhere(map, keyframe, k, options); });
}

std::vector<LandmarkId> landmarks_in(const Keyframe& keyframe) {
  std::vector<LandmarkId> ids;
  for (const LandmarkId id : keyframe.landmarks) {
    if (id != kNone) ids.push_back(id);
  }
  return ids;
}

/// The keyframes in which a new one's landmarks are looked for, ascending: its neighbours and
/// theirs.
std::vector<KeyframeId> fuse_targets(const Map& map, KeyframeId id,
                                     const PointMappingOptions& options) {
  std::vector<KeyframeId> targets =
      best_neighbours(map, id, static_cast<std::size_t>(options.fuse_neighbours));
  // Neighbours of the best few are enough: their own neighbours overlap.
  constexpr std::size_t kAsked = 5;
  const std::vector<KeyframeId> best(
      targets.begin(),
      targets.begin() + static_cast<std::ptrdiff_t>(std::min(kAsked, targets.size())));
  for (const KeyframeId neighbour : best) {
    for (const KeyframeId second : best_neighbours(map, neighbour, 5)) {
      if (second != id) targets.push_back(second);
    }
  }
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
  return targets;
}

/// What of a new keyframe's landmarks is worth looking for elsewhere. The keyframe before it was
/// asked the same, so that what both see has been looked for in the neighbours of both.
class NotTriedBefore {
 public:
  NotTriedBefore(const Map& map, KeyframeId id) : all_(landmarks_in(map.keyframes.at(id))) {
    KeyframeId before = id - 1;
    while (before >= 0 && !map.keyframes.contains(before)) --before;
    if (before < 0) return;
    std::vector<char> seen(static_cast<std::size_t>(map.landmarks.next_id()), 0);
    for (const LandmarkId landmark : map.keyframes.at(before).landmarks) {
      if (landmark != kNone) seen[static_cast<std::size_t>(landmark)] = 1;
    }
    for (const LandmarkId landmark : all_) {
      if (seen[static_cast<std::size_t>(landmark)] == 0) new_.push_back(landmark);
    }
    neighbours_of_before_.assign(static_cast<std::size_t>(map.keyframes.next_id()), 0);
    for (const auto& [neighbour, shared] : map.covisible(before)) {
      neighbours_of_before_[static_cast<std::size_t>(neighbour)] = 1;
    }
  }
  const std::vector<LandmarkId>& in(KeyframeId target) const {
    const bool tried = !neighbours_of_before_.empty() &&
                       neighbours_of_before_[static_cast<std::size_t>(target)] != 0;
    return tried ? new_ : all_;
  }

 private:
  std::vector<LandmarkId> all_;
  std::vector<LandmarkId> new_;  ///< not seen by the keyframe before
  std::vector<char> neighbours_of_before_;
};

}  // namespace

std::vector<KeyframeId> best_neighbours(const Map& map, KeyframeId keyframe, std::size_t most) {
  std::vector<KeyframeId> ids;
  for (const auto& [id, shared] : map.covisible(keyframe)) {
    if (ids.size() == most) break;
    ids.push_back(id);
  }
  return ids;
}

bool wide_enough(const Map& map, const Keyframe& keyframe, const Keyframe& neighbour, bool rgbd,
                 const PointMappingOptions& options) {
  const double baseline = (keyframe.centre_world() - neighbour.centre_world()).norm();
  return baseline >= (rgbd ? options.min_baseline_m
                           : options.min_baseline_share * map.median_depth(neighbour.id));
}

std::optional<Eigen::Vector3d> point_from_two(const Camera& camera, const Keyframe& a,
                                              const Keypoint& in_a, const Keyframe& b,
                                              const Keypoint& in_b,
                                              const PointMappingOptions& options) {
  const Eigen::Vector2d pixel_a = in_a.pixel.cast<double>();
  const Eigen::Vector2d pixel_b = in_b.pixel.cast<double>();
  const Eigen::Vector3d ray_a = a.cam_from_world.linear().transpose() * camera.ray(pixel_a);
  const Eigen::Vector3d ray_b = b.cam_from_world.linear().transpose() * camera.ray(pixel_b);
  const double cosine = ray_a.dot(ray_b) / (ray_a.norm() * ray_b.norm());
  if (cosine <= 0.0 || cosine > options.min_parallax_cosine) return std::nullopt;
  const std::optional<Eigen::Vector3d> point =
      triangulate(camera, a.cam_from_world, pixel_a, b.cam_from_world, pixel_b);
  if (!point) return std::nullopt;
  const double sigma_a = options.levels.sigma_px(in_a.octave);
  const double sigma_b = options.levels.sigma_px(in_b.octave);
  if (squared_error_px(camera, a.cam_from_world, *point, in_a) >
          options.chi2_mono * sigma_a * sigma_a ||
      squared_error_px(camera, b.cam_from_world, *point, in_b) >
          options.chi2_mono * sigma_b * sigma_b) {
    return std::nullopt;
  }
  if (!scales_agree(a, in_a, b, in_b, *point, options.levels)) return std::nullopt;
  return point;
}

LandmarkId put_landmark(Map& map, const Eigen::Vector3d& position, KeyframeId keyframe,
                        const cv::Mat& image, const Keypoint& keypoint) {
  Landmark landmark;
  landmark.id = map.landmarks.next_id();
  landmark.position = position;
  landmark.first_keyframe = keyframe;
  landmark.color = color_at(image, keypoint.raw);
  map.landmarks.put(landmark);
  return landmark.id;
}

void cull_landmarks(Map& map, KeyframeId keyframe, bool rgbd, const PointMappingOptions& options,
                    PointMappingStats& stats) {
  // A landmark from depth needs one more observer than its maker, a triangulated one two.
  const int too_few_observers = rgbd ? 1 : 2;
  std::vector<LandmarkId> doomed;
  for (const Landmark& landmark : map.landmarks) {
    const int age = keyframe - landmark.first_keyframe;
    if (age < 1 || age > options.trial_keyframes) continue;
    const auto observers = static_cast<int>(landmark.observations.size());
    if (landmark.found_ratio() < options.min_found_ratio ||
        (age >= 2 && observers <= too_few_observers)) {
      doomed.push_back(landmark.id);
    }
  }
  for (const LandmarkId id : doomed) map.erase_landmark(id);
  stats.culled += static_cast<int>(doomed.size());
}

void create_landmarks(Map& map, KeyframeId id, const Camera& camera, bool rgbd,
                      const cv::Mat& image, const PointMappingOptions& options,
                      PointMappingStats& stats) {
  const auto most =
      static_cast<std::size_t>(rgbd ? options.neighbours_rgbd : options.neighbours_mono);
  for (const KeyframeId neighbour_id : best_neighbours(map, id, most)) {
    const Keyframe& keyframe = map.keyframes.at(id);
    const Keyframe& neighbour = map.keyframes.at(neighbour_id);
    if (!wide_enough(map, keyframe, neighbour, rgbd, options)) continue;
    for (const auto& [i, j] : match_along_epipolar(keyframe, neighbour, camera, options.levels)) {
      const Keypoint& in_a = keyframe.features->keypoints[static_cast<std::size_t>(i)];
      const Keypoint& in_b = neighbour.features->keypoints[static_cast<std::size_t>(j)];
      const std::optional<Eigen::Vector3d> point =
          point_from_two(camera, keyframe, in_a, neighbour, in_b, options);
      if (!point) continue;
      const LandmarkId landmark = put_landmark(map, *point, id, image, in_a);
      map.add_observation(landmark, id, i);
      map.add_observation(landmark, neighbour_id, j);
      map.update_landmark_summary(landmark, options.levels);
      ++stats.triangulated;
    }
  }
}

void create_landmarks_from_depth(Map& map, KeyframeId id, const Camera& camera,
                                 const cv::Mat& image, const PointMappingOptions& options,
                                 PointMappingStats& stats) {
  const std::shared_ptr<const Features> features = map.keyframes.at(id).features;
  const Pose world_from_cam = map.keyframes.at(id).cam_from_world.inverse();
  for (int k = 0; k < features->size(); ++k) {
    const Keypoint& keypoint = features->keypoints[static_cast<std::size_t>(k)];
    if (map.keyframes.at(id).landmarks[static_cast<std::size_t>(k)] != kNone ||
        keypoint.depth <= 0.0F || keypoint.depth > options.max_landmark_depth_m) {
      continue;
    }
    const Eigen::Vector3d point_cam = camera.ray(keypoint.pixel.cast<double>()) * keypoint.depth;
    const LandmarkId landmark = put_landmark(map, world_from_cam * point_cam, id, image, keypoint);
    map.add_observation(landmark, id, k);
    map.update_landmark_summary(landmark, options.levels);
    ++stats.from_depth;
  }
}

void fuse_landmarks_into(Map& map, const std::vector<LandmarkId>& candidates, KeyframeId id,
                         const Camera& camera, const PointMappingOptions& options,
                         PointMappingStats& stats) {
  std::vector<Expectation> expectations;
  const Keyframe& keyframe = map.keyframes.at(id);
  std::vector<char> seen(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  for (const LandmarkId landmark : keyframe.landmarks) {
    if (landmark != kNone) seen[static_cast<std::size_t>(landmark)] = 1;
  }
  for (const LandmarkId candidate : candidates) {
    const Landmark* landmark = map.landmarks.find(candidate);
    if (landmark == nullptr || seen[static_cast<std::size_t>(candidate)] != 0) continue;
    Expectation expectation;
    if (!expect_landmark(*landmark, camera, keyframe.cam_from_world, options.levels, expectation)) {
      continue;
    }
    expectation.radius_px = 3.0 * options.levels.scale(expectation.max_octave);
    expectations.push_back(expectation);
  }
  ExpectationMatchOptions match;
  match.max_distance = kStrictDistance;
  match.ratio = 1.0;
  const auto pairs = match_expectations(*keyframe.features, expectations, {}, match);
  for (const auto& [keypoint_index, e] : pairs) {
    const LandmarkId candidate = expectations[static_cast<std::size_t>(e)].landmark;
    const Landmark* landmark = map.landmarks.find(candidate);
    if (landmark == nullptr) continue;
    const auto k = static_cast<std::size_t>(keypoint_index);
    const Keypoint& keypoint = keyframe.features->keypoints[k];
    const double sigma = options.levels.sigma_px(keypoint.octave);
    if (squared_error_px(camera, keyframe.cam_from_world, landmark->position, keypoint) >
        options.chi2_mono * sigma * sigma) {
      continue;
    }
    const LandmarkId present = keyframe.landmarks[k];
    if (present == candidate) continue;
    if (present == kNone) {
      map.add_observation(candidate, id, keypoint_index);
    } else if (map.landmarks.at(present).observations.size() >= landmark->observations.size()) {
      map.replace_landmark(candidate, present);
    } else {
      map.replace_landmark(present, candidate);
    }
    ++stats.fused;
  }
}

void fuse_landmarks(Map& map, KeyframeId id, const Camera& camera,
                    const PointMappingOptions& options, PointMappingStats& stats) {
  const std::vector<KeyframeId> targets = fuse_targets(map, id, options);
  const NotTriedBefore not_tried(map, id);
  for (const KeyframeId target : targets) {
    fuse_landmarks_into(map, not_tried.in(target), target, camera, options, stats);
  }
  std::vector<char> around(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  for (const KeyframeId target : targets) {
    for (const LandmarkId landmark : map.keyframes.at(target).landmarks) {
      if (landmark != kNone) around[static_cast<std::size_t>(landmark)] = 1;
    }
  }
  std::vector<LandmarkId> candidates;
  for (std::size_t i = 0; i < around.size(); ++i) {
    if (around[i] != 0) candidates.push_back(static_cast<LandmarkId>(i));
  }
  fuse_landmarks_into(map, candidates, id, camera, options, stats);
  for (const LandmarkId landmark : landmarks_in(map.keyframes.at(id))) {
    map.update_landmark_summary(landmark, options.levels);
  }
}

void cull_keyframes(Map& map, KeyframeId keyframe, const PointMappingOptions& options,
                    PointMappingStats& stats) {
  for (const auto& [id, shared] : map.covisible(keyframe)) {
    if (id <= 1 || !is_redundant(map, map.keyframes.at(id), options)) continue;
    map.erase_keyframe(id);
    ++stats.keyframes_culled;
  }
}

}  // namespace planecast::slam
