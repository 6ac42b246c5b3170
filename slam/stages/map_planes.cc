#include "slam/stages/map_planes.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "slam/stages/plane_steps.h"
#include "slam/stages/stereo_planes.h"

namespace planecast::slam {

namespace {

/// Adds the time from its making to its end; figures only, no result depends on it.
class StepTimer {
 public:
  explicit StepTimer(double& total_ms) : total_ms_(total_ms) {}
  ~StepTimer() {
    const std::chrono::duration<double, std::milli> passed = Clock::now() - start_;
    total_ms_ += passed.count();
  }
  StepTimer(const StepTimer&) = delete;
  StepTimer& operator=(const StepTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& total_ms_;
  Clock::time_point start_ = Clock::now();
};

/// Whether somebody said of any keyframe where planes are in it.
bool has_masks(const Map& map) {
  for (const Keyframe& keyframe : map.keyframes) {
    if (std::any_of(keyframe.labels.begin(), keyframe.labels.end(),
                    [](int label) { return label > 0; })) {
      return true;
    }
  }
  return false;
}

/// Mean distance of the keyframe's landmarks from its camera; 0 without landmarks.
double mean_distance(const Map& map, KeyframeId id) {
  const Keyframe& keyframe = map.keyframes.at(id);
  double sum = 0.0;
  int count = 0;
  for (const LandmarkId landmark_id : keyframe.landmarks) {
    const Landmark* landmark = map.landmarks.find(landmark_id);
    if (landmark == nullptr) continue;
    sum += (keyframe.cam_from_world * landmark->position).norm();
    ++count;
  }
  return count == 0 ? 0.0 : sum / count;
}

/// Thresholds for this keyframe. Mono follows the median depth; RGB-D keeps what the first keyframe
/// gave.
PlaneScale scale_at(const Map& map, KeyframeId keyframe, const PlaneMappingOptions& options,
                    bool rgbd, const PlaneScale& previous) {
  if (rgbd && previous.eps_d > 0.0) return previous;
  const double scale = rgbd ? mean_distance(map, keyframe) : map.median_depth(keyframe);
  if (!(scale > 0.0)) return previous;
  return {options.eps_d * scale, options.eps_pi * scale, options.eps_d * scale};
}

}  // namespace

PlaneMapper::PlaneMapper(const PlaneMappingOptions& options, const Camera& camera, bool rgbd)
    : options_(options), camera_(camera), rgbd_(rgbd) {}

PlaneContext PlaneMapper::context_of(const Map& map) const {
  /// Landmarks of fewer keyframes fill any slab.
  constexpr std::size_t kYoung = 8;
  return {options_, scale_, camera_, rgbd_, map.keyframes.size() < kYoung, finished_};
}

void PlaneMapper::cull_non_planar(Map& map, KeyframeId keyframe, PlaneMappingStats& stats) {
  if (!map.keyframes.contains(keyframe)) return;
  const StepTimer timer(stats.cull_ms);
  scale_ = scale_at(map, keyframe, options_, rgbd_, scale_);
  if (!(scale_.eps_d > 0.0)) return;
  stats.culled += cull_far_landmarks(map, keyframe, context_of(map));
}

void PlaneMapper::update(Map& map, KeyframeId keyframe, PlaneMappingStats& stats) {
  if (!map.keyframes.contains(keyframe)) return;
  if (!(scale_.eps_d > 0.0)) scale_ = scale_at(map, keyframe, options_, rgbd_, scale_);
  if (!(scale_.eps_d > 0.0)) return;
  const PlaneContext context = context_of(map);
  KeyframePoints shown;
  std::vector<GrowingPlane> growing;
  {
    // What an existing plane explains must not become a second plane, so that planes grow first
    // [D].
    const StepTimer timer(stats.merge_expand_ms);
    shown = gather_points(map, keyframe, context);
    prepare_growth(map, context, growing);
    stats.expanded += expand_planes(map, keyframe, context, shown, growing);
  }
  {
    const StepTimer timer(stats.new_ms);
    stats.new_planes += find_planes(map, keyframe, context, shown);
  }
  {
    const StepTimer timer(stats.merge_expand_ms);
    prepare_growth(map, context, growing);
    stats.expanded += expand_planes(map, keyframe, context, shown, growing);
    doubt_planes(map, context, shown);
    stats.merged += merge_planes(map, context, shown);
  }
  {
    const StepTimer timer(stats.reestimate_ms);
    stats.reestimated += reestimate_planes(map, keyframe, context);
    stats.dropped += drop_weak_planes(map, context);
  }
  if (!options_.project) return;
  const StepTimer timer(stats.refine_ms);
  const RefineCounts counts = project_landmarks(map, keyframe, context);
  stats.refined += counts.refined;
  stats.refused += counts.refused;
}

void PlaneMapper::search_again(Map& map, PlaneMappingStats& stats) {
  /// Of the thresholds of a growing map.
  constexpr double kTighter = 0.5;
  const bool project = std::exchange(options_.project, false);
  for (const Keyframe& keyframe : map.keyframes) {
    scale_ = scale_at(map, keyframe.id, options_, rgbd_, scale_);
    const PlaneScale growing = scale_;
    scale_.eps_d *= kTighter;
    scale_.eps_pi *= kTighter;
    update(map, keyframe.id, stats);
    scale_ = growing;
  }
  options_.project = project;
}

void PlaneMapper::finish(Map& map, PlaneMappingStats& stats) {
  follow_map(map);
  if (!(scale_.eps_d > 0.0) || options_.merge == PlaneMerge::kPaper) return;
  finished_ = true;
  if (rgbd_ || has_masks(map)) {
    stats.merged += merge_planes(map, context_of(map), {});
  } else {
    search_again(map, stats);
  }
  settle_planes(map, context_of(map));
  finished_ = false;
}

void PlaneMapper::find_in_stereo(Map& map, int threads) {
  /// Of the noise model, at which depth by pairs is as precise as a sensor's.
  constexpr double kMedianDepth_m = 2.5;
  if (rgbd_ || !(scale_.eps_d > 0.0) || options_.merge == PlaneMerge::kPaper) return;
  std::vector<double> depths;
  for (const Keyframe& keyframe : map.keyframes) depths.push_back(map.median_depth(keyframe.id));
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  if (!(*middle > 0.0)) return;
  PlaneContext context = context_of(map);
  context.scale = {options_.eps_d * *middle, options_.eps_pi * *middle, options_.eps_d * *middle};
  context.metre = *middle / kMedianDepth_m;
  StereoPlaneOptions stereo;
  stereo.depth.threads = threads;
  find_stereo_planes(map, context, stereo);
}

void PlaneMapper::follow_map(Map& map) {
  if (!(scale_.eps_d > 0.0)) return;
  refit_planes(map, context_of(map));
}

}  // namespace planecast::slam
