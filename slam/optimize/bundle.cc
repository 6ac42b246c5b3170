#include "slam/optimize/bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "slam/optimize/bundle_problem.h"
#include "slam/optimize/schur_solver.h"

namespace planecast::slam {
namespace {

/// Iterations of the local bundle's first pass, [K].
constexpr int kLocalFirstIterations = 5;
/// Where the local bundle's passes end. The first has only to tell outliers, for which one step
/// mostly will do; the second ends where its step moved the poses by a seventh of their standard
/// deviation, as the next keyframe goes on from it.
constexpr double kLocalFirstTolerance = 3e-1;
constexpr double kLocalTolerance = 1e-4;
constexpr double kLocalPoseTolerance = 0.02;
constexpr double kGlobalTolerance = 1e-5;

int first_keyframe(const Map& map) {
  return map.keyframes.empty() ? kNone : (*map.keyframes.begin()).id;
}

/// What leaves the scale of the problem open, so that it has to be put back: the one fixed keyframe
/// and the oldest free one. Both kNone where the scale is held by depth or by two fixed keyframes.
struct ScaleGauge {
  int anchor = kNone;
  int other = kNone;
  double distance = 0.0;
};

ScaleGauge find_scale_gauge(const BundleProblem& problem) {
  ScaleGauge gauge;
  const auto fixed = std::count_if(problem.fixed.begin(), problem.fixed.end(),
                                   [](char is_fixed) { return is_fixed != 0; });
  if (fixed != 1 || problem.has_depth()) return gauge;
  for (int i = 0; i < static_cast<int>(problem.fixed.size()); ++i) {
    if (problem.fixed[static_cast<std::size_t>(i)]) {
      gauge.anchor = i;
    } else if (gauge.other == kNone) {
      gauge.other = i;
    }
  }
  if (gauge.other != kNone) {
    gauge.distance = keyframe_distance(problem, gauge.anchor, gauge.other);
  }
  return gauge;
}

struct Pass {
  int iterations = 0;
  RobustLoss loss = RobustLoss::kCauchy;
  double tolerance = kGlobalTolerance;
};

struct Schedule {
  Pass first;  ///< to tell outliers
  Pass second;
  bool refine_focal = false;
  double focal_sigma = 0.0;
  bool window = false;  ///< by solve_window
};

int solve(BundleProblem& problem, const Schedule& schedule, const Pass& pass) {
  const ResidualSpread spread =
      pass.loss == RobustLoss::kCauchy ? measure_spread(problem) : ResidualSpread{};
  if (schedule.window) {
    return solve_window(problem,
                        {pass.iterations, pass.loss, pass.tolerance, spread, kLocalPoseTolerance});
  }
  BundleSolve options;
  options.refine_focal = schedule.refine_focal;
  options.focal_sigma = schedule.focal_sigma;
  options.iterations = pass.iterations;
  options.loss = pass.loss;
  options.spread = spread;
  options.function_tolerance = pass.tolerance;
  return solve_bundle(problem, options);
}

/// The two passes, to tell outliers and to find the minimum, from a collected problem to the
/// changed map.
BundleResult run_bundle(BundleProblem& problem, const Schedule& schedule, Map& map) {
  BundleResult result;
  result.fixed_keyframes = static_cast<int>(
      std::count_if(problem.fixed.begin(), problem.fixed.end(), [](char f) { return f != 0; }));
  result.free_keyframes = static_cast<int>(problem.keyframes.size()) - result.fixed_keyframes;
  result.landmarks = static_cast<int>(problem.points.size());
  result.observations = static_cast<int>(problem.observations.size());
  const ScaleGauge gauge = find_scale_gauge(problem);

  // A single point behind a camera would stop the solver at its first step.
  deactivate_outliers(problem, std::numeric_limits<double>::infinity());
  result.rms_before_px = reprojection_rms_px(problem);
  result.iterations = solve(problem, schedule, schedule.first);
  deactivate_outliers(problem);
  result.iterations += solve(problem, schedule, schedule.second);
  deactivate_outliers(problem);
  if (gauge.other != kNone) restore_distance(problem, gauge.anchor, gauge.other, gauge.distance);
  result.rms_after_px = reprojection_rms_px(problem);
  result.focal_factor = problem.focal_factor;
  write_back(problem, map);
  result.removed_observations = remove_inactive(problem, map);
  return result;
}

/// `centre` and its best neighbours, ascending.
std::vector<KeyframeId> local_window(const Map& map, KeyframeId centre, int max_keyframes) {
  std::vector<KeyframeId> window = {centre};
  for (const auto& [id, shared] : map.covisible(centre)) {
    if (static_cast<int>(window.size()) >= max_keyframes) break;
    window.push_back(id);
  }
  std::sort(window.begin(), window.end());
  return window;
}

std::vector<LandmarkId> landmarks_seen(const Map& map, const std::vector<KeyframeId>& window) {
  std::vector<char> seen(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  for (const KeyframeId keyframe : window) {
    for (const LandmarkId landmark : map.keyframes.at(keyframe).landmarks) {
      if (landmark != kNone) seen[static_cast<std::size_t>(landmark)] = 1;
    }
  }
  std::vector<LandmarkId> landmarks;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i]) landmarks.push_back(static_cast<LandmarkId>(i));
  }
  return landmarks;
}

/// Keyframes outside the window that see most of its landmarks, ties by id.
std::vector<KeyframeId> outer_observers(const Map& map, const std::vector<KeyframeId>& window,
                                        const std::vector<LandmarkId>& landmarks, int max_count) {
  std::vector<int> shared(static_cast<std::size_t>(map.keyframes.next_id()), 0);
  for (const LandmarkId landmark : landmarks) {
    for (const Observation& observation : map.landmarks.at(landmark).observations) {
      ++shared[static_cast<std::size_t>(observation.keyframe)];
    }
  }
  for (const KeyframeId id : window) shared[static_cast<std::size_t>(id)] = 0;
  std::vector<KeyframeId> observers;
  for (KeyframeId id = 0; id < map.keyframes.next_id(); ++id) {
    if (shared[static_cast<std::size_t>(id)] > 0) observers.push_back(id);
  }
  std::stable_sort(observers.begin(), observers.end(), [&](KeyframeId a, KeyframeId b) {
    return shared[static_cast<std::size_t>(a)] > shared[static_cast<std::size_t>(b)];
  });
  if (static_cast<int>(observers.size()) > max_count) {
    observers.resize(static_cast<std::size_t>(std::max(0, max_count)));
  }
  return observers;
}

}  // namespace

BundleResult local_bundle(Map& map, const Camera& camera, KeyframeId centre,
                          const BundleOptions& options) {
  if (!map.keyframes.contains(centre)) return {};
  const std::vector<KeyframeId> window =
      local_window(map, centre, std::max(1, options.max_local_keyframes));
  const std::vector<LandmarkId> landmarks = landmarks_seen(map, window);
  std::vector<KeyframeId> keyframes =
      outer_observers(map, window, landmarks, options.max_fixed_keyframes);
  keyframes.insert(keyframes.end(), window.begin(), window.end());
  std::sort(keyframes.begin(), keyframes.end());
  std::vector<char> fixed;
  fixed.reserve(keyframes.size());
  for (const KeyframeId id : keyframes) {
    fixed.push_back(id == first_keyframe(map) ||
                    !std::binary_search(window.begin(), window.end(), id));
  }
  // Without any outer observer nothing else holds the window in its place.
  if (std::find(fixed.begin(), fixed.end(), 1) == fixed.end()) fixed.front() = 1;
  BundleProblem problem = collect_bundle(map, camera, keyframes, fixed, landmarks, options);
  Schedule schedule;
  schedule.first = {kLocalFirstIterations, RobustLoss::kCauchy, kLocalFirstTolerance};
  schedule.second = {options.iterations, RobustLoss::kCauchy, kLocalTolerance};
  schedule.window = true;
  return run_bundle(problem, schedule, map);
}

BundleResult global_bundle(Map& map, Camera& camera, const BundleOptions& options) {
  if (map.keyframes.empty()) return {};
  BundleProblem problem = collect_whole_map(map, camera, options);
  Schedule schedule;
  // The start may be far off, as after a loop: outliers are told only once it has settled.
  schedule.first = {options.iterations, RobustLoss::kHuber, kGlobalTolerance};
  schedule.second = {options.iterations, RobustLoss::kCauchy, kGlobalTolerance};
  schedule.refine_focal = options.refine_focal;
  schedule.focal_sigma = options.focal_sigma * std::sqrt(options.focal_independence);
  const BundleResult result = run_bundle(problem, schedule, map);
  camera.fx *= result.focal_factor;
  camera.fy *= result.focal_factor;
  return result;
}

}  // namespace planecast::slam
