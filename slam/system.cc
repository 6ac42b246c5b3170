#include "slam/system.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace planecast::slam {
namespace {

class Stopwatch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// One set of pyramid levels for every stage.
SystemOptions with_common_levels(SystemOptions options) {
  const ScaleLevels levels = options.orb.levels;
  options.initialise.levels = levels;
  options.initialise.seed = options.seed;
  options.track.localise.levels = levels;
  options.track.relocalise.localise.levels = levels;
  options.track.relocalise.seed = options.seed;
  options.points.levels = levels;
  options.bundle.levels = levels;
  options.planes.seed = options.seed;
  return options;
}

/// Depth at a raw pixel; 0 where the 3x3 window disagrees, as at the edge of an object.
float depth_at(const cv::Mat& depth, const Eigen::Vector2f& raw, double max_depth_m) {
  const int x = static_cast<int>(std::lround(raw.x()));
  const int y = static_cast<int>(std::lround(raw.y()));
  if (x < 1 || y < 1 || x >= depth.cols - 1 || y >= depth.rows - 1) return 0.0F;
  const float centre = depth.at<float>(y, x);
  if (!(centre > 0.0F) || centre > static_cast<float>(max_depth_m)) return 0.0F;
  const float slack = 0.03F * centre;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const float other = depth.at<float>(y + dy, x + dx);
      if (other > 0.0F && std::abs(other - centre) > slack) return 0.0F;
    }
  }
  return centre;
}

PoseEstimate estimate_of_keyframe(const Keyframe& keyframe) {
  PoseEstimate estimate;
  estimate.cam_from_world = keyframe.cam_from_world;
  estimate.matches = keyframe.landmarks;
  estimate.inliers = static_cast<int>(
      std::count_if(estimate.matches.begin(), estimate.matches.end(),
                    [](LandmarkId id) { return id != kNone; }));
  return estimate;
}

void append_plane_times(const PlaneMappingStats& stats, StageTimes& times) {
  times.emplace_back("Non-Planar Map Point Culling", stats.cull_ms);
  times.emplace_back("New Plane Detection", stats.new_ms);
  times.emplace_back("Plane Merging/Expanding", stats.merge_expand_ms);
  times.emplace_back("Plane Re-estimation", stats.reestimate_ms);
  times.emplace_back("Point-Plane Refinement", stats.refine_ms);
}

}  // namespace

System::System(const SystemOptions& options, const Camera& camera,
               std::unique_ptr<PlaneSegmenter> segmenter)
    : options_(with_common_levels(options)),
      camera_(camera),
      segmenter_(std::move(segmenter)),
      extractor_(std::make_unique<OrbExtractor>(options_.orb)),
      initialiser_(options_.initialise, camera),
      tracker_(options_.track, camera, options_.rgbd),
      plane_mapper_(options_.planes, camera, options_.rgbd) {}

System::~System() = default;

ImageFeatures System::prepare(const FrameInput& frame, bool initialised) const {
  ImageFeatures image;
  image.frame_index = frame.index;
  image.timestamp = frame.timestamp;
  image.grey_or_bgr = frame.image;
  image.labels = frame.labels;
  if (options_.rgbd) image.depth = frame.depth;
  cv::Mat grey = frame.image;
  if (frame.image.channels() == 3) cv::cvtColor(frame.image, grey, cv::COLOR_BGR2GRAY);
  const int limit = initialised || options_.rgbd ? options_.orb.features : options_.initial_features;
  auto features = std::make_shared<Features>(extractor_->extract(grey, camera_, limit));
  if (!image.depth.empty()) {
    for (Keypoint& keypoint : features->keypoints) {
      keypoint.depth = depth_at(image.depth, keypoint.raw, options_.max_keypoint_depth_m);
    }
  }
  image.features = std::move(features);
  return image;
}

cv::Mat System::segment(const ImageFeatures& image, StageTimes& times) const {
  Stopwatch watch;
  FrameInput frame;
  frame.index = image.frame_index;
  frame.timestamp = image.timestamp;
  frame.image = image.grey_or_bgr;
  frame.depth = image.depth;
  frame.labels = image.labels;
  cv::Mat labels = segmenter_->segment(frame);
  times.emplace_back("Instance Planar Segmentation", watch.lap_ms());
  return labels;
}

void System::restart() {
  map_ = Map();
  initialiser_.reset();
  tracker_ = Tracker(options_.track, camera_, options_.rgbd);
  plane_mapper_ = PlaneMapper(options_.planes, camera_, options_.rgbd);
  lost_frames_ = 0;
}

void System::start_mono(const ImageFeatures& image, FrameTrack& result) {
  Stopwatch watch;
  const InitialiseResult started = initialiser_.try_image(image, map_);
  result.times.emplace_back("System (Mono) Initialization", watch.lap_ms());
  if (!started.done) {
    result.reason = started.reason;
    return;
  }
  if (options_.map_planes) {
    ImageFeatures reference = *initialiser_.reference();
    for (const KeyframeId id : {0, 1}) {
      ImageFeatures& source = id == 0 ? reference : const_cast<ImageFeatures&>(image);
      Keyframe& keyframe = map_.keyframes.at(id);
      keyframe.label_image = segment(source, result.mapping_times);
      if (keyframe.label_image.empty()) continue;
      for (std::size_t k = 0; k < keyframe.labels.size(); ++k) {
        keyframe.labels[k] =
            label_at(keyframe.label_image, keyframe.features->keypoints[k].raw);
      }
    }
    watch.lap_ms();
    PlaneMappingStats stats;
    map_planes_after(0, stats);
    map_planes_after(1, stats);
    result.mapping_times.emplace_back("Point-Plane Map Initialization", watch.lap_ms());
  }
  tracker_.start(image, estimate_of_keyframe(map_.keyframes.at(1)), 1);
  result.state = TrackState::kTracked;
  result.keyframe = true;
  result.reference = 1;
  result.cam_from_world = map_.keyframes.at(1).cam_from_world;
  result.inliers = static_cast<int>(map_.landmarks.size());
}

void System::start_rgbd(const ImageFeatures& image, FrameTrack& result) {
  ImageFeatures segmented = image;
  if (options_.map_planes) segmented.labels = segment(image, result.mapping_times);
  const InitialiseResult started = initialise_rgbd(segmented, camera_, options_.orb.levels,
                                                   options_.initialise.min_landmarks, map_);
  if (!started.done) {
    result.reason = started.reason;
    return;
  }
  if (options_.map_planes) {
    Stopwatch watch;
    PlaneMappingStats stats;
    map_planes_after(0, stats);
    result.mapping_times.emplace_back("Point-Plane Map Initialization", watch.lap_ms());
  }
  tracker_.start(image, estimate_of_keyframe(map_.keyframes.at(0)), 0);
  result.state = TrackState::kTracked;
  result.keyframe = true;
  result.reference = 0;
  result.cam_from_world = Pose::Identity();
  result.inliers = static_cast<int>(map_.landmarks.size());
}

void System::map_planes_after(KeyframeId keyframe, PlaneMappingStats& stats) {
  plane_mapper_.cull_non_planar(map_, keyframe, stats);
  plane_mapper_.update(map_, keyframe, stats);
}

void System::count_visible(const TrackResult& result) {
  for (const LandmarkId id : result.estimate.visible) {
    if (Landmark* landmark = map_.landmarks.find(id)) ++landmark->visible;
  }
  for (const LandmarkId id : result.estimate.matches) {
    if (Landmark* landmark = map_.landmarks.find(id)) ++landmark->found;
  }
}

void System::insert_keyframe(const ImageFeatures& image, const PoseEstimate& estimate,
                             FrameTrack& result) {
  Stopwatch total;
  StageTimes& times = result.mapping_times;
  ImageFeatures segmented = image;
  segmented.labels = options_.map_planes ? segment(image, times) : cv::Mat();
  Stopwatch watch;
  Keyframe keyframe = make_keyframe(segmented, estimate.cam_from_world, map_);
  const KeyframeId id = keyframe.id;
  keyframe.parent = result.reference;
  map_.keyframes.put(std::move(keyframe));
  for (std::size_t k = 0; k < estimate.matches.size(); ++k) {
    if (estimate.matches[k] == kNone) continue;
    map_.add_observation(estimate.matches[k], id, static_cast<int>(k));
    map_.update_landmark_summary(estimate.matches[k], options_.orb.levels);
  }
  PointMappingStats points;
  PlaneMappingStats planes;
  cull_landmarks(map_, id, options_.rgbd, options_.points, points);
  if (options_.map_planes) plane_mapper_.cull_non_planar(map_, id, planes);
  watch.lap_ms();
  create_landmarks(map_, id, camera_, options_.rgbd, image.grey_or_bgr, options_.points, points);
  times.emplace_back("Triangulation", watch.lap_ms());
  fuse_landmarks(map_, id, camera_, options_.rgbd, options_.points, points);
  times.emplace_back("Fusing", watch.lap_ms());
  if (options_.map_planes) plane_mapper_.update(map_, id, planes);
  watch.lap_ms();
  local_bundle(map_, camera_, id, options_.bundle);
  times.emplace_back("Local BA", watch.lap_ms());
  if (options_.map_planes) {
    plane_mapper_.follow_map(map_);
    append_plane_times(planes, times);
  }
  cull_keyframes(map_, id, options_.points, points);
  times.emplace_back("Local Mapping", total.lap_ms());
  tracker_.keyframe_inserted(id, image.frame_index, map_);
  tracker_.follow_map(map_);
  result.keyframe = true;
  result.reference = id;
  result.cam_from_reference = Pose::Identity();
}

FrameTrack System::track(const ImageFeatures& image) {
  FrameTrack result;
  if (lost_frames_ >= options_.restart_after_lost &&
      static_cast<int>(map_.keyframes.size()) < options_.restart_keyframes) {
    restart();
    result.restarted = true;
  }
  if (!initialised()) {
    options_.rgbd ? start_rgbd(image, result) : start_mono(image, result);
    return result;
  }
  Stopwatch watch;
  const TrackResult tracked = tracker_.track(image, map_);
  result.times.emplace_back("Tracking", watch.lap_ms());
  if (!tracked.tracked) {
    ++lost_frames_;
    result.state = TrackState::kLost;
    result.reason = tracked.reason;
    return result;
  }
  lost_frames_ = 0;
  count_visible(tracked);
  result.state = TrackState::kTracked;
  result.inliers = tracked.estimate.inliers;
  result.cam_from_world = tracked.estimate.cam_from_world;
  result.reference = tracked.reference;
  result.cam_from_reference =
      tracked.estimate.cam_from_world * map_.keyframe_pose(tracked.reference).inverse();
  if (tracked.want_keyframe) insert_keyframe(image, tracked.estimate, result);
  return result;
}

FinishResult System::finish() {
  FinishResult result;
  if (map_.keyframes.size() < 2) return result;
  BundleOptions bundle = options_.bundle;
  bundle.iterations = 20;
  bundle.refine_focal = camera_.guessed;
  result.global = global_bundle(map_, camera_, bundle);
  if (!options_.map_planes) return result;
  plane_mapper_.follow_map(map_);
  if (options_.refine_jointly && !map_.planes.empty()) {
    JointOptions joint;
    joint.bundle = bundle;
    joint.plane_sigma = plane_mapper_.scale().eps_pi;
    result.joint = refine_jointly(map_, camera_, joint);
  }
  for (const Landmark& landmark : map_.landmarks) {
    map_.update_landmark_summary(landmark.id, options_.orb.levels);
  }
  return result;
}

std::optional<PoseEstimate> System::localise(
    const ImageFeatures& image, const std::optional<Pose>& prior_cam_from_world) const {
  if (!initialised()) return std::nullopt;
  const LocaliseOptions& options = options_.track.localise;
  if (prior_cam_from_world) {
    PoseEstimate prior;
    prior.cam_from_world = *prior_cam_from_world;
    prior.matches.assign(image.features->keypoints.size(), kNone);
    std::vector<KeyframeId> everywhere;
    for (const Keyframe& keyframe : map_.keyframes) everywhere.push_back(keyframe.id);
    PoseEstimate estimate =
        search_local_map(map_, camera_, *image.features, prior, everywhere, 2.0, options);
    if (estimate.inliers >= options_.track.min_inliers) {
      estimate = search_local_map(map_, camera_, *image.features, estimate, everywhere, 1.0, options);
      if (estimate.inliers >= options_.track.min_inliers) return estimate;
    }
  }
  return relocalise(map_, camera_, *image.features, options_.track.relocalise);
}

}  // namespace planecast::slam
