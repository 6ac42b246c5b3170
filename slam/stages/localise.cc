#include "slam/stages/localise.h"

#include <algorithm>
#include <utility>

#include "slam/features/matching.h"
#include "slam/geometry/lens.h"
#include "slam/optimize/pose.h"

namespace planecast::slam {

PoseEstimate optimise_matches(const Map& map, const Camera& camera, const Features& features,
                              const Pose& prior_cam_from_world, std::vector<LandmarkId> matches,
                              const ScaleLevels& levels) {
  std::vector<PoseObservation> observations;
  std::vector<std::size_t> keypoint_of;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (matches[k] == kNone) continue;
    const Keypoint& keypoint = features.keypoints[k];
    PoseObservation observation;
    observation.point_world = map.landmarks.at(matches[k]).position;
    observation.pixel = keypoint.pixel.cast<double>();
    observation.sigma_px = levels.sigma_px(keypoint.octave);
    observation.depth = keypoint.depth;
    observations.push_back(observation);
    keypoint_of.push_back(k);
  }
  PoseEstimate estimate;
  estimate.cam_from_world = prior_cam_from_world;
  if (observations.size() >= 4) {
    const PoseResult result = optimize_pose(camera, prior_cam_from_world, observations);
    estimate.cam_from_world = result.cam_from_world;
    estimate.rms = result.rms;
    estimate.information = result.information;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (result.inlier[i] == 0) matches[keypoint_of[i]] = kNone;
    }
  } else {
    std::fill(matches.begin(), matches.end(), kNone);
  }
  estimate.inliers = static_cast<int>(
      std::count_if(matches.begin(), matches.end(), [](LandmarkId id) { return id != kNone; }));
  estimate.matches = std::move(matches);
  return estimate;
}

std::vector<LandmarkId> supporting_landmarks(const PoseEstimate& estimate) {
  std::vector<LandmarkId> landmarks;
  for (const LandmarkId id : estimate.matches) {
    if (id != kNone) landmarks.push_back(id);
  }
  for (const PatchMatch& patch : estimate.patches) landmarks.push_back(patch.landmark);
  return landmarks;
}

namespace {

/// Whether something nearer stands, clearly, before a landmark.
bool is_hidden(const Landmark& landmark, const Camera& camera, const Pose& cam_from_world,
               const cv::Mat& depth) {
  constexpr double kClearly = 0.9;
  const Eigen::Vector3d point = cam_from_world * landmark.position;
  const Eigen::Vector2d raw = project_raw(camera, point);
  const cv::Point pixel(cvRound(raw.x()), cvRound(raw.y()));
  if (!cv::Rect(cv::Point(), depth.size()).contains(pixel)) return false;
  const auto seen = static_cast<double>(depth.at<float>(pixel));
  return seen > 0.0 && seen < kClearly * point.z();
}

}  // namespace

std::optional<PoseEstimate> localise_by_patches(const Map& map, const Camera& camera,
                                                const ImageFeatures& image,
                                                const Pose& guess_cam_from_world,
                                                const std::vector<LandmarkId>& candidates,
                                                const LocaliseByPatchesOptions& options) {
  PatchMatches found =
      match_patches(map, camera, *image.pyramid, guess_cam_from_world, candidates, options.match);
  if (!image.depth.empty()) {
    std::erase_if(found.tried, [&](LandmarkId id) {
      return is_hidden(map.landmarks.at(id), camera, guess_cam_from_world, image.depth);
    });
  }
  const auto least = std::max(static_cast<double>(options.min_inliers),
                              options.min_share * static_cast<double>(found.tried.size()));
  if (static_cast<double>(found.matches.size()) < least) return std::nullopt;
  std::vector<PoseObservation> observations;
  observations.reserve(found.matches.size());
  for (const PatchMatch& match : found.matches) {
    PoseObservation observation;
    observation.point_world = map.landmarks.at(match.landmark).position;
    observation.pixel = match.pixel;
    observation.sigma_px = match.sigma_px();
    if (!image.depth.empty()) {
      observation.depth = depth_at(image.depth, match.raw, options.max_depth_m);
    }
    observations.push_back(observation);
  }
  const PoseResult result = optimize_pose(camera, guess_cam_from_world, observations);
  if (result.num_inliers < least) return std::nullopt;
  PoseEstimate estimate;
  estimate.cam_from_world = result.cam_from_world;
  estimate.rms = result.rms;
  estimate.information = result.information;
  estimate.inliers = result.num_inliers;
  estimate.visible = std::move(found.tried);
  for (std::size_t i = 0; i < found.matches.size(); ++i) {
    if (result.inlier[i] != 0) estimate.patches.push_back(found.matches[i]);
  }
  return estimate;
}

std::vector<LandmarkId> landmarks_of(const Map& map, const std::vector<KeyframeId>& keyframes) {
  std::vector<char> known(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  std::vector<LandmarkId> landmarks;
  for (const KeyframeId keyframe : keyframes) {
    for (const LandmarkId id : map.keyframes.at(keyframe).landmarks) {
      if (id == kNone || known[static_cast<std::size_t>(id)] != 0) continue;
      known[static_cast<std::size_t>(id)] = 1;
      landmarks.push_back(id);
    }
  }
  return landmarks;
}

std::vector<KeyframeId> local_keyframes(const Map& map, const std::vector<LandmarkId>& in_view,
                                        const LocaliseOptions& options) {
  std::vector<int> votes(static_cast<std::size_t>(map.keyframes.next_id()), 0);
  for (const LandmarkId id : in_view) {
    if (id == kNone) continue;
    for (const Observation& observation : map.landmarks.at(id).observations) {
      ++votes[static_cast<std::size_t>(observation.keyframe)];
    }
  }
  std::vector<KeyframeId> direct;
  for (const Keyframe& keyframe : map.keyframes) {
    if (votes[static_cast<std::size_t>(keyframe.id)] > 0) direct.push_back(keyframe.id);
  }
  std::stable_sort(direct.begin(), direct.end(), [&](KeyframeId a, KeyframeId b) {
    return votes[static_cast<std::size_t>(a)] > votes[static_cast<std::size_t>(b)];
  });
  std::vector<KeyframeId> result = direct;
  std::vector<char> chosen(votes.size(), 0);
  for (const KeyframeId id : direct) chosen[static_cast<std::size_t>(id)] = 1;
  const auto most = static_cast<std::size_t>(options.max_local_keyframes);
  // Neighbours of the best few are enough: their own neighbours overlap.
  for (std::size_t d = 0; d < std::min<std::size_t>(direct.size(), 5) && result.size() < most;
       ++d) {
    int added = 0;
    for (const auto& [id, shared] : map.covisible(direct[d])) {
      if (added == options.neighbours_each) break;
      ++added;
      if (chosen[static_cast<std::size_t>(id)] != 0) continue;
      chosen[static_cast<std::size_t>(id)] = 1;
      result.push_back(id);
    }
  }
  if (result.size() > most) result.resize(most);
  return result;
}

PoseEstimate search_local_map(const Map& map, const Camera& camera, const Features& features,
                              const PoseEstimate& prior, const std::vector<KeyframeId>& keyframes,
                              double widen, const LocaliseOptions& options) {
  std::vector<char> known(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  std::vector<LandmarkId> visible;
  for (const LandmarkId id : prior.matches) {
    if (id == kNone) continue;
    known[static_cast<std::size_t>(id)] = 1;
    visible.push_back(id);
  }
  std::vector<Expectation> expectations;
  for (const KeyframeId keyframe : keyframes) {
    for (const LandmarkId id : map.keyframes.at(keyframe).landmarks) {
      if (id == kNone || known[static_cast<std::size_t>(id)] != 0) continue;
      known[static_cast<std::size_t>(id)] = 1;
      Expectation expectation;
      if (!expect_landmark(map.landmarks.at(id), camera, prior.cam_from_world, options.levels,
                           expectation)) {
        continue;
      }
      expectation.radius_px *= widen;
      expectations.push_back(expectation);
      visible.push_back(id);
    }
  }
  ExpectationMatchOptions match;
  match.ratio = options.local_map_ratio;
  std::vector<LandmarkId> matches = prior.matches;
  for (const auto& [k, e] : match_expectations(features, expectations, prior.matches, match)) {
    matches[static_cast<std::size_t>(k)] = expectations[static_cast<std::size_t>(e)].landmark;
  }
  PoseEstimate estimate = optimise_matches(map, camera, features, prior.cam_from_world,
                                           std::move(matches), options.levels);
  std::sort(visible.begin(), visible.end());
  estimate.visible = std::move(visible);
  return estimate;
}

}  // namespace planecast::slam
