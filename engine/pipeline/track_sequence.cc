#include "engine/pipeline/track_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "engine/cancel.h"
#include "engine/pipeline/earlier_map.h"
#include "engine/pipeline/frames_ahead.h"
#include "engine/pipeline/map_change_recorder.h"
#include "engine/pipeline/map_to_records.h"
#include "engine/pipeline/system_options.h"
#include "engine/scene/plane_classes.h"
#include "engine/user_error.h"
#include "slam/stages/check_path.h"
#include "slam/stages/smooth_path.h"
#include "slam/system.h"

namespace planecast::engine {
namespace {

/// One frame of the first pass, as the second needs it.
struct Tracked {
  slam::KeyframeId reference = slam::kNone;
  slam::Pose cam_from_reference = slam::Pose::Identity();
};

class TwoPassTracker {
 public:
  TwoPassTracker(Sequence& sequence, const TrackSequenceOptions& options, const Progress& progress)
      : sequence_(sequence),
        options_(options),
        progress_(progress),
        rgbd_(use_depth(sequence, options)),
        earlier_(read_earlier_map(options.map, sequence, rgbd_)),
        system_(system_options(options, rgbd_), earlier_.camera,
                make_segmenter(sequence, rgbd_, options)),
        first_(sequence.first_frame()),
        count_(sequence.end_frame() - sequence.first_frame()) {
    frames_.resize(static_cast<std::size_t>(count_));
    tracked_.resize(static_cast<std::size_t>(count_));
    localised_.resize(static_cast<std::size_t>(count_));
    times_.resize(static_cast<std::size_t>(count_));
    if (earlier_.map != nullptr) {
      system_.load(*earlier_.map);
      first_own_keyframe_ = earlier_.map->keyframes.next_id();
      map_changes_.start_at(first_own_keyframe_);
    }
  }

  Reconstruction run() {
    first_pass();
    if (stopped_ != kInterrupted) finish();
    take_over_references();
    if (!options_.causal && stopped_ != kInterrupted) second_pass();
    return records();
  }

 private:
  int total_steps() const { return options_.causal ? count_ : 2 * count_; }
  void first_pass();
  void stop_before(int position, std::string reason);
  void finish();
  void second_pass();
  void take_over_references();
  void localise_run(int begin, int end, int step, int& done);
  bool localise_frame(int position, const std::vector<slam::Pose>& priors,
                      const slam::ImageFeatures& image);
  void smooth();
  void mend(std::size_t begin, std::vector<slam::PathPose>& path);
  void record_first(int position, const slam::FrameTrack& track);
  slam::Pose new_from_old_world(int position) const;
  slam::Pose moved_on(const slam::Pose& cam_from_world, int from, int to) const;
  Reconstruction records();

  Sequence& sequence_;
  const TrackSequenceOptions& options_;
  const Progress& progress_;
  bool rgbd_;
  EarlierMap earlier_;
  slam::System system_;
  slam::KeyframeId first_own_keyframe_ = 0;
  int first_;
  int count_;
  std::vector<FrameRecord> frames_;
  std::vector<Tracked> tracked_;
  std::vector<std::optional<slam::PathPose>> localised_;  ///< in the second pass
  std::vector<StageTimes> times_;
  MapChangeRecorder map_changes_;
  std::map<std::string, std::vector<double>> mapping_times_;
  slam::JointResult joint_;
  std::string stopped_;  ///< why the frames end before the sequence
};

void TwoPassTracker::record_first(int position, const slam::FrameTrack& track) {
  const auto p = static_cast<std::size_t>(position);
  FrameRecord& record = frames_[p];
  record.state = track.state == slam::TrackState::kTracked ? "tracked"
                 : track.state == slam::TrackState::kLost  ? "lost"
                                                           : "not-initialised";
  record.reason = track.reason;
  record.inliers = track.inliers;
  times_[p].insert(times_[p].end(), track.times.begin(), track.times.end());
  for (const auto& [stage, ms] : track.mapping_times) mapping_times_[stage].push_back(ms);
  if (track.restarted) {
    // The thrown-away map's poses mean nothing in the new one.
    for (std::size_t q = 0; q < p; ++q) {
      tracked_[q] = {};
      frames_[q].causal_world_from_cam.reset();
    }
    map_changes_.clear();
  }
  map_changes_.record(system_.map(), first_ + position, new_from_old_world(position));
  if (!track.cam_from_world) return;
  record.causal_world_from_cam = track.cam_from_world->inverse();
  tracked_[p] = {track.reference, track.cam_from_reference};
}

/// What the map's change at this frame did to the camera of the last tracked frame before.
slam::Pose TwoPassTracker::new_from_old_world(int position) const {
  for (int before = position - 1; before >= 0; --before) {
    const auto p = static_cast<std::size_t>(before);
    if (!frames_[p].causal_world_from_cam || tracked_[p].reference == slam::kNone) continue;
    const slam::Pose cam_from_new_world =
        system_.map().from_keyframe(tracked_[p].cam_from_reference, tracked_[p].reference);
    return cam_from_new_world.inverse() * frames_[p].causal_world_from_cam->inverse();
  }
  return slam::Pose::Identity();
}

void TwoPassTracker::first_pass() {
  FramesAhead ahead(sequence_, system_, first_, first_ + count_, options_.threads > 1, 1);
  // Whether the map was initialised is known two frames late, always.
  ahead.request(system_.initialised());
  for (int position = 0; position < count_; ++position) {
    if (cancel_requested()) return stop_before(position, kInterrupted);
    FramesAhead::Prepared prepared = ahead.take();
    const bool initialised = system_.initialised();
    if (position + 1 < count_) ahead.request(initialised);
    FrameRecord& record = frames_[static_cast<std::size_t>(position)];
    record.index = first_ + position;
    record.timestamp =
        prepared.image ? prepared.image->timestamp : sequence_.timestamp(record.index);
    if (prepared.image) {
      record_first(position, system_.track(*prepared.image));
    } else {
      if (!options_.skip_unreadable) return stop_before(position, prepared.error);
      record.state = "unreadable";
      record.reason = "not readable";
    }
    if (progress_) progress_(position + 1, total_steps());
  }
}

/// What comes before is kept and completed.
void TwoPassTracker::stop_before(int position, std::string reason) {
  if (position == 0 && reason != kInterrupted) throw UserError(reason);
  stopped_ = std::move(reason);
  count_ = position;
  const auto size = static_cast<std::size_t>(position);
  frames_.resize(size);
  tracked_.resize(size);
  localised_.resize(size);
  times_.resize(size);
}

void TwoPassTracker::finish() {
  const slam::FinishResult finished = system_.finish();
  for (const auto& [stage, ms] : finished.mapping_times) mapping_times_[stage].push_back(ms);
  joint_ = finished.joint;
}

/// Poses of the first pass, carried along with the keyframes as the map changed since.
void TwoPassTracker::take_over_references() {
  for (int position = 0; position < count_; ++position) {
    const auto p = static_cast<std::size_t>(position);
    if (tracked_[p].reference == slam::kNone) continue;
    const slam::Pose cam_from_world =
        system_.map().from_keyframe(tracked_[p].cam_from_reference, tracked_[p].reference);
    frames_[p].world_from_cam = cam_from_world.inverse();
  }
}

bool TwoPassTracker::localise_frame(int position, const std::vector<slam::Pose>& priors,
                                    const slam::ImageFeatures& image) {
  const std::optional<slam::PoseEstimate> estimate = system_.localise(image, priors);
  if (!estimate) return false;
  FrameRecord& record = frames_[static_cast<std::size_t>(position)];
  record.world_from_cam = estimate->cam_from_world.inverse();
  record.inliers = estimate->inliers;
  // Poses that claim to be better than a tenth of the expected errors are not believed.
  constexpr double kLeastVariance = 0.01;
  localised_[static_cast<std::size_t>(position)] = slam::PathPose{
      estimate->cam_from_world,
      estimate->information / std::max(estimate->rms * estimate->rms, kLeastVariance)};
  if (record.state != "tracked") record.state = "localised";
  return true;
}

/// A pose at one frame, carried to another by what the first pass saw of the motion between them.
slam::Pose TwoPassTracker::moved_on(const slam::Pose& cam_from_world, int from, int to) const {
  const auto& before = frames_[static_cast<std::size_t>(from)].causal_world_from_cam;
  const auto& after = frames_[static_cast<std::size_t>(to)].causal_world_from_cam;
  if (!before || !after) return cam_from_world;
  return after->inverse() * *before * cam_from_world;
}

/// Localises the frames begin, begin + step, ... before end; those without a pose of their own
/// start from the frame before them in this order.
void TwoPassTracker::localise_run(int begin, int end, int step, int& done) {
  FramesAhead ahead(sequence_, system_, first_ + begin, first_ + end, options_.threads > 1, step);
  int requested = begin;
  for (int i = 0; i < FramesAhead::kMost && requested != end; ++i, requested += step) {
    ahead.request(true);
  }
  std::optional<slam::Pose> previous;
  for (int position = begin; position != end && !cancel_requested(); position += step) {
    FramesAhead::Prepared prepared = ahead.take();
    if (requested != end) {
      ahead.request(true);
      requested += step;
    }
    const FrameRecord& record = frames_[static_cast<std::size_t>(position)];
    std::vector<slam::Pose> priors;
    if (record.world_from_cam) priors.push_back(record.world_from_cam->inverse());
    // What the final adjustment changed between a frame and its reference shows at its neighbour.
    if (previous) priors.push_back(moved_on(*previous, position - step, position));
    if (prepared.image) localise_frame(position, priors, *prepared.image);
    if (record.world_from_cam) previous = record.world_from_cam->inverse();
    if (progress_) progress_(count_ + std::min(++done, count_), total_steps());
  }
}

void TwoPassTracker::second_pass() {
  if (system_.map().keyframes.empty()) return;
  const auto posed = [](const FrameRecord& record) { return record.world_from_cam.has_value(); };
  const auto first_posed = std::find_if(frames_.begin(), frames_.end(), posed);
  if (first_posed == frames_.end()) return;
  const auto start = static_cast<int>(first_posed - frames_.begin());
  int done = 0;
  localise_run(start, count_, 1, done);
  // Backwards from the start: what came before the initialisation.
  localise_run(start, -1, -1, done);
  // What is still missing after a loss is tried from its later side.
  for (int position = count_ - 1; position > start && !cancel_requested(); --position) {
    if (frames_[static_cast<std::size_t>(position)].world_from_cam ||
        frames_[static_cast<std::size_t>(position)].state == "unreadable") {
      continue;
    }
    if (position + 1 == count_ || !frames_[static_cast<std::size_t>(position + 1)].world_from_cam) {
      continue;
    }
    const slam::Pose prior =
        frames_[static_cast<std::size_t>(position + 1)].world_from_cam->inverse();
    localise_frame(position, {prior}, system_.prepare(sequence_.read(first_ + position), true));
  }
  if (cancel_requested()) {
    stopped_ = kInterrupted;
  } else {
    smooth();
  }
}

/// Tries frames of a run whose poses contradict their neighbours' once more, from where those put
/// them. What still contradicts is left to its neighbours. The run's frames start at `begin`.
void TwoPassTracker::mend(std::size_t begin, std::vector<slam::PathPose>& path) {
  std::vector<slam::Pose> poses;
  std::vector<int> support;
  for (std::size_t i = 0; i < path.size(); ++i) {
    poses.push_back(path[i].cam_from_world);
    support.push_back(frames_[begin + i].inliers);
  }
  const std::vector<char> trusted = slam::check_path(poses, support);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (trusted[i] != 0) continue;
    const auto position = static_cast<int>(begin + i);
    const slam::FrameInput frame = sequence_.read(first_ + position);
    if (!localise_frame(position, {slam::pose_between(poses, trusted, i)},
                        system_.prepare(frame, true))) {
      continue;
    }
    path[i] = *localised_[begin + i];
    support[i] = frames_[begin + i].inliers;
  }
  for (std::size_t i = 0; i < path.size(); ++i) poses[i] = path[i].cam_from_world;
  const std::vector<char> still_trusted = slam::check_path(poses, support);
  constexpr double kShareOfDoubtful = 1e-4;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (still_trusted[i] != 0) continue;
    path[i].cam_from_world = slam::pose_between(poses, still_trusted, i);
    path[i].information *= kShareOfDoubtful;
    frames_[begin + i].reason = "contradicts its neighbours";
  }
}

/// Smooths each run of frames that were localised one after the other.
void TwoPassTracker::smooth() {
  std::vector<double> gaps;
  for (std::size_t p = 1; p < frames_.size(); ++p) {
    gaps.push_back(frames_[p].timestamp - frames_[p - 1].timestamp);
  }
  if (gaps.empty()) return;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2),
                   gaps.end());
  // A frame that the recorder dropped is a gap as well.
  const double longest_gap = 1.5 * gaps[gaps.size() / 2];
  for (std::size_t begin = 0; begin < frames_.size();) {
    std::vector<slam::PathPose> path;
    std::size_t end = begin;
    for (; end < frames_.size() && localised_[end]; ++end) {
      if (end > begin && frames_[end].timestamp - frames_[end - 1].timestamp > longest_gap) break;
      path.push_back(*localised_[end]);
    }
    mend(begin, path);
    const std::vector<slam::Pose> smooth = slam::smooth_path(path);
    for (std::size_t i = 0; i < smooth.size(); ++i) {
      frames_[begin + i].world_from_cam = smooth[i].inverse();
    }
    begin = std::max(end, begin + 1);
  }
}

Reconstruction TwoPassTracker::records() {
  Reconstruction result =
      map_to_records(system_.map(), system_.camera(), earlier_.metric, first_own_keyframe_);
  result.map = std::make_shared<const slam::Map>(system_.map());
  result.mode = rgbd_ ? "rgbd" : "mono";
  result.segmentation = system_.segmentation();
  if (joint_.plane_rms_before > 0.0) {
    result.plane_rms = PlaneRms{joint_.plane_rms_before,
                                joint_.kept ? joint_.plane_rms_after : joint_.plane_rms_before};
  }
  result.frames = std::move(frames_);
  result.map_changes = map_changes_.take();
  result.frame_times = std::move(times_);
  result.mapping_times = std::move(mapping_times_);
  result.warnings = sequence_.warnings();
  result.stopped = stopped_;
  UpOptions up_options;
  up_options.known_up = options_.up;
  classify_planes(result, up_options);
  return result;
}

}  // namespace

Reconstruction track_sequence(Sequence& sequence, const TrackSequenceOptions& options,
                              const Progress& progress) {
  return TwoPassTracker(sequence, options, progress).run();
}

bool was_interrupted(const Reconstruction& reconstruction) {
  return reconstruction.stopped == kInterrupted;
}

void require_complete(const Reconstruction& reconstruction) {
  if (reconstruction.stopped.empty()) return;
  if (!was_interrupted(reconstruction)) throw UserError(reconstruction.stopped);
  throw Cancelled(fmt::format("{} frames were tracked", reconstruction.frames.size()));
}

}  // namespace planecast::engine
