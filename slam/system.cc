#include "slam/system.h"

#include <algorithm>
#include <utility>

#include "slam/stages/refine_sights.h"
#include "slam/stages/stopwatch.h"

namespace planecast::slam {
namespace {

PrepareOptions prepare_options(const SystemOptions& options) {
  PrepareOptions prepare;
  prepare.orb = options.orb;
  prepare.rgbd = options.rgbd;
  prepare.max_keypoint_depth_m = options.max_keypoint_depth_m;
  return prepare;
}

/// One set of pyramid levels and one seed for every stage.
SystemOptions with_common_values(SystemOptions options) {
  if (options.track.front_end == FrontEnd::kPatches) options.orb.levels = options.patch_levels;
  const ScaleLevels levels = options.orb.levels;
  options.initialise.levels = levels;
  options.initialise.tracks.scale_levels = levels;
  options.initialise.features = options.initial_features;
  options.initialise.by_patches = options.track.front_end == FrontEnd::kPatches;
  if (options.initialise.by_patches) {
    // Followed corners are good to a fraction of a pixel, so that a little less parallax than with
    // features will do. With half of it, a table seen from above started with wrong depths.
    options.initialise.two_view.sigma_px = 0.3;
    options.initialise.two_view.min_parallax_deg = 0.8;
  }
  options.initialise.seed = options.seed;
  options.track.localise.levels = levels;
  options.track.relocalise.localise.levels = levels;
  options.track.relocalise.seed = options.seed;
  options.mapping.rgbd = options.rgbd;
  options.mapping.points.levels = levels;
  options.mapping.bundle.levels = levels;
  options.mapping.planes.seed = options.seed;
  options.track.relocalise.vocabulary = options.vocabulary;
  options.loops.rgbd = options.rgbd;
  options.loops.verify.with_scale = !options.rgbd;
  options.loops.verify.seed = options.seed;
  options.loops.verify.levels = levels;
  options.loops.points = options.mapping.points;
  options.loops.bundle = options.mapping.bundle;
  options.mapping.prepare = prepare_options(options);
  options.track.patches.min_inliers = options.track.min_inliers;
  options.track.patches.max_depth_m = options.max_keypoint_depth_m;
  options.track.patches.match.levels = levels;
  options.mapping.describe.patches.levels = levels;
  options.mapping.describe.localise = options.track.localise;
  // Those that see what the tracker found are enough.
  options.mapping.describe.localise.neighbours_each = 0;
  options.mapping.describe.keypoints = options.orb.features;
  options.mapping.describe.min_corners = 2 * options.orb.features / 5;
  options.mapping.search.points = options.mapping.points;
  options.mapping.search_by_patches = options.track.front_end == FrontEnd::kPatches;
  return options;
}

PoseEstimate estimate_of_keyframe(const Keyframe& keyframe) {
  PoseEstimate estimate;
  estimate.cam_from_world = keyframe.cam_from_world;
  estimate.matches = keyframe.landmarks;
  estimate.inliers = static_cast<int>(std::count_if(
      estimate.matches.begin(), estimate.matches.end(), [](LandmarkId id) { return id != kNone; }));
  return estimate;
}

}  // namespace

System::System(const SystemOptions& options, const Camera& camera,
               std::unique_ptr<PlaneSegmenter> segmenter)
    : options_(with_common_values(options)),
      camera_(camera),
      preparer_(std::make_unique<ImagePreparer>(options_.mapping.prepare, camera)),
      tracker_preparer_(std::make_unique<ImagePreparer>(options_.mapping.prepare, camera)),
      initialiser_(options_.initialise, options_.mapping.prepare, camera),
      tracker_(options_.track, camera, options_.rgbd),
      mapper_(options_.mapping, camera, std::move(segmenter)) {
  if (options_.close_loops && options_.vocabulary != nullptr) {
    loop_finder_.emplace(options_.loops, camera_, options_.vocabulary);
  }
}

System::~System() {
  if (open_loop_) open_loop_->correction.wait();
  for (const InFlight& flight : in_flight_) flight.result.wait();
}

ImageFeatures System::prepare(const FrameInput& frame, bool initialised) const {
  ImageFeatures image = preparer_->read(frame);
  if (options_.track.front_end == FrontEnd::kOrb || (options_.rgbd && !initialised)) {
    preparer_->extract(
        image, initialised || options_.rgbd ? options_.orb.features : options_.initial_features);
  }
  return image;
}

void System::load(Map map) {
  working_map_ = std::move(map);
  if (options_.vocabulary != nullptr) describe_keyframes(working_map_, *options_.vocabulary);
  visible_map_ = std::make_shared<const Map>(working_map_);
  loaded_ = true;
}

void System::restart() {
  FrameTrack ignored;
  take_over_all(ignored);
  working_map_ = Map();
  visible_map_ = std::make_shared<const Map>();
  initialiser_.reset();
  tracker_ = Tracker(options_.track, camera_, options_.rgbd);
  mapper_.reset();
  if (loop_finder_) loop_finder_->reset();
  next_job_ = {};
  lost_frames_ = 0;
}

void System::start(ImageFeatures& image, FrameTrack& result) {
  Stopwatch watch;
  const std::optional<ImageFeatures> reference = initialiser_.reference();
  const InitialiseResult started =
      options_.rgbd ? initialise_rgbd(image, camera_, options_.orb.levels,
                                      options_.initialise.min_landmarks, working_map_)
                    : initialiser_.try_image(image, working_map_);
  if (!options_.rgbd) result.times.emplace_back("System (Mono) Initialization", watch.lap_ms());
  if (!started.done) {
    result.reason = started.reason;
    return;
  }
  std::vector<ImageFeatures> images;
  if (reference && !options_.rgbd) images.push_back(*reference);
  images.push_back(image);
  const KeyframeReport report = mapper_.start(working_map_, images);
  result.mapping_times = report.times;
  if (options_.vocabulary != nullptr) describe_keyframes(working_map_, *options_.vocabulary);
  visible_map_ = std::make_shared<const Map>(working_map_);
  const KeyframeId newest = map().keyframes.next_id() - 1;
  tracker_.start(image, estimate_of_keyframe(map().keyframes.at(newest)), newest);
  result.state = TrackState::kTracked;
  result.keyframe = true;
  result.reference = newest;
  result.cam_from_world = map().keyframes.at(newest).cam_from_world;
  result.inliers = static_cast<int>(map().landmarks.size());
}

void System::hand_over(const ImageFeatures& image, const TrackResult& tracked, FrameTrack& result) {
  KeyframeJob job = std::exchange(next_job_, {});
  job.image = image;
  job.estimate = tracked.estimate;
  job.reference = tracked.reference;
  job.cam_from_reference = result.cam_from_reference;
  enqueue(image.frame_index, image.frame_index + options_.mapping_delay,
          [this, job = std::move(job)] {
            Mapped mapped;
            mapped.report = mapper_.insert(working_map_, job);
            if (loop_finder_) {
              mapped.loop = loop_finder_->look(working_map_, mapped.report.keyframe);
            } else if (options_.vocabulary != nullptr) {
              describe_keyframes(working_map_, *options_.vocabulary);
            }
            return mapped;
          });
  tracker_.keyframe_requested(image.frame_index);
  result.keyframe = true;
}

void System::enqueue(int frame_index, int visible_at, MapJob job) {
  std::shared_future<Mapped> earlier =
      in_flight_.empty() ? std::shared_future<Mapped>() : in_flight_.back().result;
  InFlight flight;
  flight.inserted_at = frame_index;
  flight.visible_at = visible_at;
  if (!in_flight_.empty()) {
    flight.visible_at = std::max(flight.visible_at, in_flight_.back().visible_at + 1);
  }
  flight.result = std::async(options_.threads > 1 ? std::launch::async : std::launch::deferred,
                             [this, earlier, job = std::move(job)]() mutable {
                               // Let go of it, or each result would hold all before it, with their
                               // maps.
                               if (earlier.valid()) std::exchange(earlier, {}).wait();
                               Mapped mapped = job();
                               mapped.map = std::make_shared<const Map>(working_map_);
                               return mapped;
                             })
                      .share();
  in_flight_.push_back(std::move(flight));
}

void System::begin_loop(const Mapped& mapped, int inserted_at) {
  open_loop_ =
      OpenLoop{inserted_at + options_.loop_delay,
               std::async(options_.threads > 1 ? std::launch::async : std::launch::deferred,
                          [this, map = mapped.map, match = *mapped.loop] {
                            return correct_loop(*map, camera_, match, options_.loops);
                          })
                   .share()};
}

/// Queues the carrying over of the loop among the keyframes so that it is due when it should be.
void System::enqueue_open_loop(int frame_index) {
  if (!open_loop_ || frame_index + options_.mapping_delay < open_loop_->visible_at) return;
  const OpenLoop loop = *std::exchange(open_loop_, std::nullopt);
  enqueue(frame_index, loop.visible_at, [this, correction = loop.correction] {
    Mapped mapped;
    Stopwatch watch;
    if (correction.get()) {
      carry_over(*correction.get(), camera_, options_.loops, working_map_);
      mapper_.follow_map(working_map_);
      mapped.loop_closed = true;
    }
    loop_finder_->closed(working_map_);
    mapped.report.times.emplace_back("Loop Closing", watch.lap_ms());
    return mapped;
  });
}

void System::take_over(InFlight flight, FrameTrack& result) {
  const Mapped& mapped = flight.result.get();
  result.mapping_times.insert(result.mapping_times.end(), mapped.report.times.begin(),
                              mapped.report.times.end());
  visible_map_ = mapped.map;
  tracker_.follow_map(map());
  result.loop_closed = result.loop_closed || mapped.loop_closed;
  if (mapped.loop) begin_loop(mapped, flight.inserted_at);
}

void System::take_over_due(int frame_index, FrameTrack& result) {
  while (!in_flight_.empty() && in_flight_.front().visible_at <= frame_index) {
    InFlight flight = std::move(in_flight_.front());
    in_flight_.pop_front();
    take_over(std::move(flight), result);
  }
}

void System::take_over_all(FrameTrack& result) {
  while (!in_flight_.empty() || open_loop_) {
    if (in_flight_.empty()) enqueue_open_loop(open_loop_->visible_at);
    take_over_due(in_flight_.back().visible_at, result);
  }
}

/// Images that were prepared before the map was there have features; patches are tried first all
/// the same.
TrackResult System::track_in_map(ImageFeatures& image) {
  if (options_.track.front_end == FrontEnd::kPatches) {
    ImageFeatures bare = image;
    bare.features = nullptr;
    TrackResult tracked = tracker_.track(bare, map());
    if (!tracked.needs_features) {
      image = std::move(bare);
      return tracked;
    }
    if (image.features == nullptr) tracker_preparer_->extract(image);
  }
  return tracker_.track(image, map());
}

FrameTrack System::track(ImageFeatures image) {
  FrameTrack result;
  take_over_due(image.frame_index, result);
  enqueue_open_loop(image.frame_index);
  take_over_due(image.frame_index, result);
  if (!loaded_ && lost_frames_ >= options_.restart_after_lost &&
      static_cast<int>(map().keyframes.size()) < options_.restart_keyframes) {
    restart();
    result.restarted = true;
  }
  if (!initialised()) {
    // After a restart the images on the way have none yet.
    if (options_.rgbd && image.features == nullptr) tracker_preparer_->extract(image);
    start(image, result);
    return result;
  }
  const double prepare_ms = image.prepare_ms;
  Stopwatch watch;
  const TrackResult tracked = track_in_map(image);
  result.times.emplace_back("Tracking", prepare_ms + watch.lap_ms());
  if (!tracked.tracked) {
    ++lost_frames_;
    result.state = TrackState::kLost;
    result.reason = tracked.reason;
    return result;
  }
  lost_frames_ = 0;
  const PoseEstimate& estimate = tracked.estimate;
  next_job_.visible.insert(next_job_.visible.end(), estimate.visible.begin(),
                           estimate.visible.end());
  const std::vector<LandmarkId> found = supporting_landmarks(estimate);
  next_job_.found.insert(next_job_.found.end(), found.begin(), found.end());
  result.state = TrackState::kTracked;
  result.inliers = estimate.inliers;
  result.cam_from_world = estimate.cam_from_world;
  result.reference = tracked.reference;
  result.cam_from_reference =
      map().relative_to_keyframe(estimate.cam_from_world, tracked.reference);
  if (tracked.want_keyframe) hand_over(image, tracked, result);
  return result;
}

FinishResult System::finish() {
  FinishResult result;
  FrameTrack last;
  take_over_all(last);
  result.mapping_times = std::move(last.mapping_times);
  result.loop_closed = last.loop_closed;
  if (working_map_.keyframes.size() < 2) return result;
  BundleOptions bundle = options_.mapping.bundle;
  bundle.iterations = 20;
  bundle.refine_focal = camera_.guessed;
  refine_sights(working_map_, camera_, options_.track.patches.match);
  result.global = global_bundle(working_map_, camera_, bundle);
  if (options_.mapping.map_planes) {
    mapper_.finish_planes(working_map_);
    if (options_.refine_jointly && !working_map_.planes.empty()) {
      JointOptions joint;
      joint.bundle = bundle;
      joint.plane_sigma = mapper_.plane_scale().eps_pi;
      result.joint = refine_jointly(working_map_, camera_, joint);
    }
    mapper_.find_planes_in_stereo(working_map_, options_.threads);
  }
  for (const Landmark& landmark : working_map_.landmarks) {
    working_map_.update_landmark_summary(landmark.id, options_.orb.levels);
  }
  visible_map_ = std::make_shared<const Map>(working_map_);
  return result;
}

std::optional<PoseEstimate> System::localise_from(const ImageFeatures& image,
                                                  const Pose& guess_cam_from_world) const {
  if (options_.track.front_end != FrontEnd::kPatches) return std::nullopt;
  std::vector<LandmarkId> everywhere;
  for (const Landmark& landmark : map().landmarks) everywhere.push_back(landmark.id);
  LocaliseByPatchesOptions patches = options_.track.patches;
  patches.match.max_matches = options_.localise_matches;
  patches.min_share = options_.localise_min_share;
  return localise_by_patches(map(), camera_, image, guess_cam_from_world, everywhere, patches);
}

std::optional<PoseEstimate> System::localise_by_keypoints(
    const Features& features, const std::optional<Pose>& prior_cam_from_world) const {
  if (prior_cam_from_world) {
    const LocaliseOptions& options = options_.track.localise;
    PoseEstimate prior;
    prior.cam_from_world = *prior_cam_from_world;
    prior.matches.assign(features.keypoints.size(), kNone);
    std::vector<KeyframeId> everywhere;
    for (const Keyframe& keyframe : map().keyframes) everywhere.push_back(keyframe.id);
    PoseEstimate estimate =
        search_local_map(map(), camera_, features, prior, everywhere, 2.0, options);
    if (estimate.inliers >= options_.track.min_inliers) {
      estimate = search_local_map(map(), camera_, features, estimate, everywhere, 1.0, options);
      if (estimate.inliers >= options_.track.min_inliers) return estimate;
    }
  }
  return relocalise(map(), camera_, features, options_.track.relocalise);
}

std::optional<PoseEstimate> System::localise(ImageFeatures image,
                                             const std::vector<Pose>& priors_cam_from_world) const {
  if (!initialised()) return std::nullopt;
  for (const Pose& prior : priors_cam_from_world) {
    std::optional<PoseEstimate> estimate = localise_from(image, prior);
    if (estimate) return estimate;
  }
  if (image.features == nullptr) tracker_preparer_->extract(image);
  std::optional<Pose> prior;
  if (!priors_cam_from_world.empty()) prior = priors_cam_from_world.front();
  std::optional<PoseEstimate> coarse = localise_by_keypoints(*image.features, prior);
  if (!coarse) return std::nullopt;
  // Keypoints are good to a pixel, which leaves the distance to a far wall open.
  std::optional<PoseEstimate> fine = localise_from(image, coarse->cam_from_world);
  return fine ? fine : coarse;
}

}  // namespace planecast::slam
