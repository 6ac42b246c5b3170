#include "slam/stages/track.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "slam/features/matching.h"

namespace planecast::slam {
namespace {

/// The keyframe that sees most of the landmarks; the newest among equals.
KeyframeId reference_of(const Map& map, const std::vector<LandmarkId>& landmarks) {
  std::vector<int> votes(static_cast<std::size_t>(map.keyframes.next_id()), 0);
  for (const LandmarkId id : landmarks) {
    for (const Observation& observation : map.landmarks.at(id).observations) {
      ++votes[static_cast<std::size_t>(observation.keyframe)];
    }
  }
  KeyframeId best = kNone;
  int most = 0;
  for (KeyframeId id = 0; id < map.keyframes.next_id(); ++id) {
    if (votes[static_cast<std::size_t>(id)] >= std::max(most, 1)) {
      most = votes[static_cast<std::size_t>(id)];
      best = id;
    }
  }
  return best;
}

/// Mean absolute difference between neighbouring pixels, in grey values.
double sharpness(const ImagePyramid& pyramid) {
  const cv::Mat& image = pyramid.levels[std::min<std::size_t>(1, pyramid.levels.size() - 1)];
  if (image.cols < 2 || image.rows < 2) return 0.0;
  double sum = 0.0;
  for (int y = 0; y < image.rows; ++y) {
    const uchar* row = image.ptr<uchar>(y);
    int line = 0;
    for (int x = 1; x < image.cols; ++x) line += std::abs(row[x] - row[x - 1]);
    sum += line;
  }
  return sum / (static_cast<double>(image.cols - 1) * image.rows);
}

/// For the user: what the image lacks, against the last one that was tracked.
std::string why_lost(const ImageFeatures& image, const ImageFeatures& last_tracked) {
  constexpr int kFewFeatures = 200;
  constexpr double kBlurredShare = 0.6;
  if (image.features->size() < kFewFeatures) return "no texture";
  if (last_tracked.pyramid != nullptr &&
      sharpness(*image.pyramid) < kBlurredShare * sharpness(*last_tracked.pyramid)) {
    return "blur";
  }
  return "too few matches";
}

}  // namespace

Tracker::Tracker(const TrackOptions& options, const Camera& camera, bool rgbd)
    : options_(options), camera_(camera), rgbd_(rgbd) {}

void Tracker::start(const ImageFeatures& image, const PoseEstimate& estimate,
                    KeyframeId reference) {
  lost_ = false;
  last_image_ = image;
  last_ = estimate;
  last_landmarks_ = supporting_landmarks(estimate);
  velocity_ = Pose::Identity();
  reference_ = reference;
  cam_from_reference_ = Pose::Identity();
  local_map_frame_ = -1;
  keyframe_requested(image.frame_index);
}

void Tracker::keyframe_requested(int frame_index) {
  last_keyframe_frame_ = frame_index;
  most_found_ = 0;
}

void Tracker::follow_map(const Map& map) {
  local_map_frame_ = -1;
  if (lost_) return;
  for (LandmarkId& id : last_.matches) {
    if (id != kNone) id = map.resolve(id);
  }
  for (LandmarkId& id : last_landmarks_) id = map.resolve(id);
  std::erase(last_landmarks_, kNone);
  last_.cam_from_world = map.from_keyframe(cam_from_reference_, reference_);
}

PoseEstimate Tracker::match_from_last(const ImageFeatures& image, const Map& map,
                                      const Pose& predicted, double window_px) const {
  std::vector<Expectation> expectations;
  for (std::size_t k = 0; k < last_.matches.size(); ++k) {
    const Landmark* landmark = map.landmarks.find(last_.matches[k]);
    if (landmark == nullptr) continue;
    const Eigen::Vector3d point_cam = predicted * landmark->position;
    if (point_cam.z() <= 0.0) continue;
    const Keypoint& seen = last_image_.features->keypoints[k];
    Expectation expectation;
    expectation.landmark = landmark->id;
    expectation.pixel = camera_.project(point_cam);
    if (!camera_.contains(expectation.pixel)) continue;
    expectation.radius_px = window_px * options_.localise.levels.scale(seen.octave);
    expectation.min_octave = seen.octave - 1;
    expectation.max_octave = seen.octave + 1;
    expectation.descriptor = last_image_.features->descriptors[k];
    expectation.angle_deg = seen.angle_deg;
    expectations.push_back(expectation);
  }
  ExpectationMatchOptions match;
  match.check_rotation = true;
  std::vector<LandmarkId> matches(image.features->keypoints.size(), kNone);
  int count = 0;
  for (const auto& [k, e] : match_expectations(*image.features, expectations, {}, match)) {
    matches[static_cast<std::size_t>(k)] = expectations[static_cast<std::size_t>(e)].landmark;
    ++count;
  }
  if (count < options_.min_motion_matches) return {};
  return optimise_matches(map, camera_, *image.features, predicted, std::move(matches),
                          options_.localise.levels);
}

/// From a pose alone, where the last image had no features.
PoseEstimate Tracker::search_about(const ImageFeatures& image, const Map& map,
                                   const Pose& predicted) const {
  PoseEstimate prior;
  prior.cam_from_world = predicted;
  prior.matches.assign(image.features->keypoints.size(), kNone);
  for (const double widen : {3.0, 8.0}) {
    const PoseEstimate estimate = search_local_map(map, camera_, *image.features, prior,
                                                   local_keyframes_, widen, options_.localise);
    if (estimate.inliers >= options_.min_motion_matches) return estimate;
  }
  return {};
}

PoseEstimate Tracker::predict_and_match(const ImageFeatures& image, const Map& map) const {
  const double window_px =
      options_.motion_window_px * std::max(camera_.width, camera_.height) / 640.0;
  const Pose predicted = velocity_ * last_.cam_from_world;
  if (last_image_.features == nullptr) {
    PoseEstimate estimate = search_about(image, map, predicted);
    if (estimate.inliers > 0) return estimate;
  } else {
    for (const double widen : {1.0, 2.0, 4.0}) {
      const Pose& prior = widen < 3.0 ? predicted : last_.cam_from_world;
      PoseEstimate estimate = match_from_last(image, map, prior, widen * window_px);
      if (estimate.inliers >= options_.min_motion_inliers) return estimate;
    }
  }
  if (map.keyframes.contains(reference_)) {
    std::optional<PoseEstimate> estimate =
        match_keyframe(map, camera_, *image.features, reference_, options_.relocalise);
    if (estimate) return *estimate;
  }
  return {};
}

bool Tracker::wants_keyframe(const ImageFeatures& image, const Map& map,
                             const TrackResult& result) const {
  const int since = image.frame_index - last_keyframe_frame_;
  // Depth counts as an observer of its own.
  const int min_observers = (map.keyframes.size() <= 2 ? 2 : 3) - (rgbd_ ? 1 : 0);
  int reference_landmarks = 0;
  for (const LandmarkId id : map.keyframes.at(result.reference).landmarks) {
    if (id == kNone) continue;
    reference_landmarks +=
        static_cast<int>(map.landmarks.at(id).observations.size()) >= min_observers;
  }
  int close_tracked = 0;
  int close_untracked = 0;
  if (rgbd_) {
    for (std::size_t k = 0; k < image.features->keypoints.size(); ++k) {
      if (image.features->keypoints[k].depth <= 0.0F) continue;
      (result.estimate.matches[k] != kNone ? close_tracked : close_untracked) += 1;
    }
  }
  const bool needs_close = rgbd_ && close_tracked < 100 && close_untracked > 70;
  const double share = rgbd_ ? options_.keyframe_share_rgbd : options_.keyframe_share_mono;
  const bool weaker = result.estimate.inliers < share * reference_landmarks || needs_close;
  if (!weaker) return false;
  if (since >= options_.max_keyframe_interval) return true;
  return since >=
         (result.estimate.inliers < options_.weak_inliers ? 1 : options_.min_keyframe_interval);
}

bool Tracker::wants_keyframe_for_patches(const ImageFeatures& image, const Map& map,
                                         const TrackResult& result) {
  most_found_ = std::max(most_found_, result.estimate.inliers);
  const int since = image.frame_index - last_keyframe_frame_;
  if (since < options_.min_keyframe_interval) return false;
  if (result.estimate.inliers < options_.keyframe_share_patches * most_found_) return true;

  const Pose& cam_from_world = result.estimate.cam_from_world;
  std::vector<double> depths;
  for (const PatchMatch& match : result.estimate.patches) {
    depths.push_back((cam_from_world * map.landmarks.at(match.landmark).position).z());
  }
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  const Eigen::Vector3d centre = cam_from_world.inverse().translation();
  constexpr double kSameViewCosine = 0.94;  // 20 degrees between the optical axes
  for (const KeyframeId id : local_keyframes_) {
    const Keyframe& keyframe = map.keyframes.at(id);
    const double axes = keyframe.cam_from_world.linear().row(2).dot(cam_from_world.linear().row(2));
    if (axes < kSameViewCosine) continue;
    if ((keyframe.centre_world() - centre).norm() < options_.keyframe_distance * *middle) {
      return false;
    }
  }
  return true;
}

void Tracker::gather_local_map(int frame_index, const Map& map) {
  if (local_map_frame_ >= 0 && frame_index - local_map_frame_ < options_.local_map_age) return;
  local_map_frame_ = frame_index;
  local_keyframes_ = local_keyframes(map, last_landmarks_, options_.localise);
  local_landmarks_ = landmarks_of(map, local_keyframes_);
}

std::optional<Pose> Tracker::align_with_last(const ImageFeatures& image, const Map& map) const {
  std::vector<Eigen::Vector3d> points;
  points.reserve(last_landmarks_.size());
  for (const LandmarkId id : last_landmarks_) {
    points.push_back(last_.cam_from_world * map.landmarks.at(id).position);
  }
  for (const Pose& guess : {velocity_, Pose(Pose::Identity())}) {
    const std::optional<Pose> cam_from_last =
        align_frame(camera_, *last_image_.pyramid, points, *image.pyramid, guess, options_.align);
    if (cam_from_last) return *cam_from_last * last_.cam_from_world;
  }
  return std::nullopt;
}

TrackResult Tracker::track_patches(const ImageFeatures& image, const Map& map) {
  TrackResult result;
  result.needs_features = true;
  if (lost_) return result;
  gather_local_map(image.frame_index, map);
  const std::optional<Pose> aligned = align_with_last(image, map);
  if (!aligned) return result;
  std::optional<PoseEstimate> estimate =
      localise_by_patches(map, camera_, image, *aligned, local_landmarks_, options_.patches);
  if (!estimate) return result;
  result.needs_features = false;
  result.tracked = true;
  result.estimate = std::move(*estimate);
  return result;
}

TrackResult Tracker::track_features(const ImageFeatures& image, const Map& map) {
  TrackResult result;
  PoseEstimate estimate;
  if (!lost_) {
    estimate = predict_and_match(image, map);
    if (estimate.inliers > 0) {
      estimate = search_local_map(map, camera_, *image.features, estimate,
                                  local_keyframes(map, estimate.matches, options_.localise), 1.0,
                                  options_.localise);
    }
    result.tracked = estimate.inliers >= options_.min_inliers;
  }
  if (!result.tracked) {
    std::optional<PoseEstimate> found =
        relocalise(map, camera_, *image.features, options_.relocalise);
    if (found) {
      estimate = std::move(*found);
      result.tracked = result.relocalised = true;
    }
  }
  if (!result.tracked) {
    result.reason = why_lost(image, last_image_);
  }
  result.estimate = std::move(estimate);
  return result;
}

void Tracker::accept(const ImageFeatures& image, const Map& map, TrackResult& result) {
  const PoseEstimate& estimate = result.estimate;
  const bool continuous = !lost_ && !result.relocalised;
  velocity_ =
      continuous ? estimate.cam_from_world * last_.cam_from_world.inverse() : Pose::Identity();
  if (!continuous) local_map_frame_ = -1;
  lost_ = false;
  last_image_ = image;
  last_ = estimate;
  last_landmarks_ = supporting_landmarks(estimate);
  reference_ = result.reference = reference_of(map, last_landmarks_);
  cam_from_reference_ = map.relative_to_keyframe(estimate.cam_from_world, reference_);
  result.want_keyframe = image.features == nullptr ? wants_keyframe_for_patches(image, map, result)
                                                   : wants_keyframe(image, map, result);
}

TrackResult Tracker::track(const ImageFeatures& image, const Map& map) {
  TrackResult result =
      image.features == nullptr ? track_patches(image, map) : track_features(image, map);
  if (result.tracked) {
    accept(image, map, result);
  } else if (!result.needs_features) {
    lost_ = true;
  }
  return result;
}

}  // namespace planecast::slam
