#include "slam/stages/initialise.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "slam/features/matching.h"
#include "slam/features/place_points.h"
#include "slam/fitting/fit_homography.h"
#include "slam/optimize/bundle.h"
#include "slam/segmentation/plane_segmenter.h"

namespace planecast::slam {
namespace {

std::string explain(TwoViewFailure failure) {
  switch (failure) {
    case TwoViewFailure::kTooLittleParallax:
      return "too little parallax";
    case TwoViewFailure::kAmbiguous:
      return "ambiguous motion";
    case TwoViewFailure::kTooFewPoints:
      return "too few points";
    case TwoViewFailure::kTooFewMatches:
      return "too few matches";
    case TwoViewFailure::kNone:
      break;
  }
  return "";
}

/// The corners moved by this share of the image's width and still show no parallax: the camera
/// turned.
constexpr double kRotationShift = 0.05;
/// Cosine between the ways of two images that agree.
constexpr double kSameWay = 0.9;

double median_shift_px(const std::vector<PointPair>& pairs) {
  std::vector<double> shifts;
  for (const PointPair& pair : pairs) shifts.push_back((pair.cur - pair.ref).norm());
  const auto middle = shifts.begin() + static_cast<std::ptrdiff_t>(shifts.size() / 2);
  std::nth_element(shifts.begin(), middle, shifts.end());
  return *middle;
}

void add_landmark(Map& map, const Eigen::Vector3d& position, const Eigen::Vector3f& color,
                  const std::vector<Observation>& observations, const ScaleLevels& levels) {
  Landmark landmark;
  landmark.id = map.landmarks.next_id();
  landmark.position = position;
  landmark.first_keyframe = observations.back().keyframe;
  landmark.color = color;
  map.landmarks.put(landmark);
  for (const Observation& observation : observations) {
    map.add_observation(landmark.id, observation.keyframe, observation.keypoint);
  }
  map.update_landmark_summary(landmark.id, levels);
}

}  // namespace

Eigen::Vector3f color_at(const cv::Mat& image, const Eigen::Vector2f& raw_pixel) {
  const int x = std::clamp(static_cast<int>(std::lround(raw_pixel.x())), 0, image.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(raw_pixel.y())), 0, image.rows - 1);
  if (image.channels() == 1) return Eigen::Vector3f::Constant(image.at<uchar>(y, x));
  const auto& bgr = image.at<cv::Vec3b>(y, x);
  return {static_cast<float>(bgr[2]), static_cast<float>(bgr[1]), static_cast<float>(bgr[0])};
}

Keyframe make_keyframe(const ImageFeatures& image, const Pose& cam_from_world, const Map& map) {
  Keyframe keyframe;
  keyframe.id = map.keyframes.next_id();
  keyframe.frame_index = image.frame_index;
  keyframe.timestamp = image.timestamp;
  keyframe.cam_from_world = cam_from_world;
  keyframe.features = image.features;
  keyframe.pyramid = image.pyramid;
  keyframe.landmarks.assign(image.features->keypoints.size(), kNone);
  keyframe.depth = image.depth;
  keyframe.label_image = image.labels;
  keyframe.labels.assign(image.features->keypoints.size(), 0);
  if (!image.labels.empty()) {
    for (std::size_t k = 0; k < keyframe.labels.size(); ++k) {
      keyframe.labels[k] = label_at(image.labels, image.features->keypoints[k].raw);
    }
  }
  return keyframe;
}

MonoInitialiser::MonoInitialiser(const InitialiseOptions& options, const PrepareOptions& prepare,
                                 const Camera& camera)
    : options_(options), camera_(camera), preparer_(prepare, camera), tracks_(options.tracks) {
  // A corner's errors are so many pixels, which a short focal length makes a larger angle.
  const double wider = std::max(1.0, options_.parallax_focal_px / std::abs(camera.fx));
  options_.two_view.min_parallax_deg *= wider;
  options_.bundle_parallax_deg *= wider;
}

bool MonoInitialiser::set_reference(ImageFeatures& image) {
  if (image.features == nullptr) preparer_.extract(image, options_.features);
  reset();
  if (image.features->size() < options_.min_features) return false;
  reference_ = image;
  guess_.clear();
  for (const Keypoint& keypoint : image.features->keypoints) {
    guess_.push_back(keypoint.pixel.cast<double>());
  }
  history_.clear();
  if (options_.by_patches) tracks_.start(*image.pyramid, *image.features);
  return true;
}

bool MonoInitialiser::is_confirmed(const TwoViewResult& two_view) {
  const std::optional<Eigen::Vector3d> before = std::exchange(way_before_, std::nullopt);
  if (two_view.failure != TwoViewFailure::kNone) return false;
  way_before_ = two_view.cur_from_ref.inverse().translation().normalized();
  return before && before->dot(*way_before_) > kSameWay;
}

void MonoInitialiser::match_tracks(const ImageFeatures& image, Matches& matches) {
  tracks_.follow(*image.pyramid);
  if (tracks_.tracks().size() < options_.min_track_share * tracks_.started()) return;
  history_.emplace_back();
  for (const CornerTrack& track : tracks_.tracks()) {
    const auto r = static_cast<std::size_t>(track.keypoint);
    matches.keypoints.emplace_back(track.keypoint, kNone);
    matches.pairs.push_back({reference_->features->keypoints[r].pixel.cast<double>(),
                             camera_.undistort(track.raw.cast<double>())});
    matches.quality.push_back(1.0F - track.correlation);
    history_.back().emplace_back(track.keypoint, matches.pairs.back().cur);
  }
}

FollowedCorners MonoInitialiser::followed() const {
  FollowedCorners corners;
  corners.pixels.resize(history_.size() + 1);
  std::vector<std::size_t> next(history_.size(), 0);
  for (const auto& [keypoint, pixel] : history_.back()) {
    const Keypoint& seen = reference_->features->keypoints[static_cast<std::size_t>(keypoint)];
    corners.pixels.front().push_back(seen.pixel.cast<double>());
    corners.sigma_px.push_back(options_.two_view.sigma_px * options_.levels.scale(seen.octave));
    for (std::size_t f = 0; f < history_.size(); ++f) {
      while (history_[f][next[f]].first != keypoint) ++next[f];
      corners.pixels[f + 1].push_back(history_[f][next[f]].second);
    }
  }
  return corners;
}

std::optional<StartBundle> MonoInitialiser::bundle_since_reference(
    const TwoViewResult& two_view, const std::vector<Pose>& candidates) const {
  const bool may_start = two_view.failure == TwoViewFailure::kNone ||
                         two_view.failure == TwoViewFailure::kTooLittleParallax ||
                         two_view.failure == TwoViewFailure::kAmbiguous;
  if (!options_.by_patches || !may_start ||
      two_view.median_parallax_deg < options_.bundle_parallax_deg) {
    return std::nullopt;
  }
  return bundle_best_start(camera_, followed(), candidates, options_.start_bundle);
}

void MonoInitialiser::match_descriptors(const ImageFeatures& image, Matches& matches) {
  const double window_px = options_.window_px * std::max(camera_.width, camera_.height) / 640.0;
  matches.keypoints =
      match_for_initialisation(*reference_->features, *image.features, guess_, window_px);
  for (const auto& [i, j] : matches.keypoints) {
    const auto r = static_cast<std::size_t>(i);
    const auto c = static_cast<std::size_t>(j);
    matches.pairs.push_back({reference_->features->keypoints[r].pixel.cast<double>(),
                             image.features->keypoints[c].pixel.cast<double>()});
    matches.quality.push_back(static_cast<float>(
        hamming_distance(reference_->features->descriptors[r], image.features->descriptors[c])));
  }
}

void MonoInitialiser::place_tracks(ImageFeatures& image, Matches& matches) {
  Features features = preparer_.detect(image, options_.features);
  std::vector<FoundPoint> points;
  for (std::size_t m = 0; m < matches.keypoints.size(); ++m) {
    const auto r = static_cast<std::size_t>(matches.keypoints[m].first);
    FoundPoint point;
    point.raw = tracks_.tracks()[m].raw;
    point.pixel = matches.pairs[m].cur;
    point.octave = reference_->features->keypoints[r].octave;
    points.push_back(point);
  }
  std::vector<char> taken(features.keypoints.size(), 0);
  const std::vector<int> placed = place_points(points, camera_, options_.snap_px, options_.levels,
                                               preparer_.extractor(), taken, features);
  preparer_.extractor().describe(features);
  for (std::size_t m = 0; m < placed.size(); ++m) matches.keypoints[m].second = placed[m];
  image.features = std::make_shared<const Features>(std::move(features));
}

TwoViewResult MonoInitialiser::solve(const std::vector<PointPair>& pairs,
                                     const std::vector<float>& quality, bool& used_homography,
                                     std::vector<Pose>& candidates) const {
  std::future<std::optional<FundamentalResult>> fundamental_task =
      std::async(std::launch::async, [&] {
        FundamentalOptions options;
        options.seed = options_.seed;
        options.sigma_px = options_.two_view.sigma_px;
        return find_fundamental(pairs, options);
      });
  HomographyOptions homography_options;
  homography_options.image_width = camera_.width;
  homography_options.image_height = camera_.height;
  homography_options.seed = options_.seed;
  const std::optional<HomographyFit> homography =
      fit_homography(pairs, quality, {}, homography_options);
  const std::optional<FundamentalResult> fundamental = fundamental_task.get();

  std::vector<char> homography_inlier;
  const double homography_score =
      homography ? score_homography(homography->cur_H_ref, pairs, options_.two_view.sigma_px,
                                    &homography_inlier)
                 : 0.0;
  const double fundamental_score = fundamental ? fundamental->score : 0.0;
  TwoViewResult none;
  none.failure = TwoViewFailure::kTooFewPoints;
  if (homography_score + fundamental_score <= 0.0) return none;

  used_homography =
      homography_score / (homography_score + fundamental_score) > options_.homography_share;
  std::vector<Pose> of_homography, of_fundamental;
  if (homography) of_homography = decompose_homography(homography->cur_H_ref, camera_);
  if (fundamental) of_fundamental = decompose_fundamental(fundamental->cur_F_ref, camera_);
  candidates = of_homography;
  candidates.insert(candidates.end(), of_fundamental.begin(), of_fundamental.end());
  return select_relative_pose(used_homography ? of_homography : of_fundamental, pairs,
                              used_homography ? homography_inlier : fundamental->inlier, camera_,
                              options_.two_view);
}

Map MonoInitialiser::two_keyframes(const ImageFeatures& image, const Matches& matches,
                                   const TwoViewResult& two_view) const {
  Map start;
  start.keyframes.put(make_keyframe(*reference_, Pose::Identity(), start));
  Keyframe second = make_keyframe(image, two_view.cur_from_ref, start);
  second.parent = 0;
  start.keyframes.put(second);
  for (std::size_t m = 0; m < matches.keypoints.size(); ++m) {
    const auto& [i, j] = matches.keypoints[m];
    if (!two_view.points_ref[m] || j == kNone) continue;
    const auto& keypoint = image.features->keypoints[static_cast<std::size_t>(j)];
    add_landmark(start, *two_view.points_ref[m], color_at(image.grey_or_bgr, keypoint.raw),
                 {{0, i}, {1, j}}, options_.levels);
  }
  return start;
}

bool MonoInitialiser::adjust(Map& start) {
  BundleOptions bundle;
  bundle.iterations = 20;
  bundle.levels = options_.levels;
  return global_bundle(start, camera_, bundle).rms_after_px <= options_.max_rms_px;
}

InitialiseResult MonoInitialiser::try_image(ImageFeatures& image, Map& map) {
  InitialiseResult result;
  if (!options_.by_patches && image.features == nullptr) {
    preparer_.extract(image, options_.features);
  }
  if (!reference_ || image.frame_index - reference_->frame_index > options_.max_reference_age) {
    result.reason = set_reference(image) ? "waiting for parallax" : "too few features";
    return result;
  }
  Matches matches;
  if (options_.by_patches) {
    match_tracks(image, matches);
  } else {
    match_descriptors(image, matches);
  }
  result.matches = static_cast<int>(matches.pairs.size());
  if (result.matches < options_.min_matches) {
    result.reason = set_reference(image) ? "too few matches" : "too few features";
    return result;
  }
  std::vector<Pose> candidates;
  TwoViewResult two_view =
      solve(matches.pairs, matches.quality, result.used_homography, candidates);
  const std::optional<StartBundle> bundle = bundle_since_reference(two_view, candidates);
  // After a turn, two views may agree on a motion that there was not: the next image finds another.
  if (!is_confirmed(two_view) && !bundle && two_view.failure == TwoViewFailure::kNone) {
    two_view.failure = TwoViewFailure::kAmbiguous;
  }
  if (bundle) {
    two_view.failure = TwoViewFailure::kNone;
    two_view.cur_from_ref = bundle->newest_from_ref;
    two_view.points_ref = bundle->points_ref;
  }
  if (two_view.failure != TwoViewFailure::kNone) {
    result.reason = two_view.failure == TwoViewFailure::kTooLittleParallax &&
                            median_shift_px(matches.pairs) > kRotationShift * camera_.width
                        ? "pure rotation"
                        : explain(two_view.failure);
    return result;
  }
  if (options_.by_patches) place_tracks(image, matches);
  Map start = two_keyframes(image, matches, two_view);
  // The frames between, which the map does not hold, have said more than its two keyframes could.
  if (!bundle && !adjust(start)) {
    result.reason = "unstable start";
    return result;
  }
  const double median_depth = start.median_depth(0);
  if (static_cast<int>(start.landmarks.size()) < options_.min_landmarks || median_depth <= 0.0) {
    result.reason = "unstable start";
    return result;
  }
  start.transform(1.0 / median_depth, Pose::Identity());
  map = std::move(start);
  result.done = true;
  return result;
}

InitialiseResult initialise_rgbd(const ImageFeatures& image, const Camera& camera,
                                 const ScaleLevels& levels, int min_landmarks, Map& map) {
  InitialiseResult result;
  int with_depth = 0;
  for (const Keypoint& keypoint : image.features->keypoints) with_depth += keypoint.depth > 0.0F;
  if (with_depth < min_landmarks) {
    result.reason = "too few features with depth";
    return result;
  }
  map = Map();
  map.keyframes.put(make_keyframe(image, Pose::Identity(), map));
  for (int k = 0; k < image.features->size(); ++k) {
    const Keypoint& keypoint = image.features->keypoints[static_cast<std::size_t>(k)];
    if (keypoint.depth <= 0.0F) continue;
    add_landmark(map, camera.ray(keypoint.pixel.cast<double>()) * keypoint.depth,
                 color_at(image.grey_or_bgr, keypoint.raw), {{0, k}}, levels);
  }
  result.done = true;
  return result;
}

}  // namespace planecast::slam
