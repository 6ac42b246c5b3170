#include "slam/optimize/bundle_problem.h"

#include <ceres/loss_function.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace planecast::slam {
namespace {

/// Above this number of free keyframes the reduced system is sparse enough for a sparse solver.
constexpr int kMaxDenseKeyframes = 120;
constexpr double kMinDistance = 1e-9;

/// Per landmark id its place in `landmarks`, kNone for all others.
std::vector<int> index_by_id(const std::vector<LandmarkId>& landmarks, int next_id) {
  std::vector<int> index(static_cast<std::size_t>(next_id), kNone);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    index[static_cast<std::size_t>(landmarks[i])] = static_cast<int>(i);
  }
  return index;
}

/// Calls visit(pose, point, keypoint) for every sight of the landmarks by the keyframes, along each
/// keyframe's keypoints as they lie in memory.
template <typename Visit>
void visit_sights(const Map& map, const std::vector<KeyframeId>& keyframes,
                  const std::vector<int>& point_of, const Visit& visit) {
  for (std::size_t pose = 0; pose < keyframes.size(); ++pose) {
    const Keyframe& keyframe = map.keyframes.at(keyframes[pose]);
    for (std::size_t k = 0; k < keyframe.landmarks.size(); ++k) {
      const LandmarkId landmark = keyframe.landmarks[k];
      if (landmark == kNone) continue;
      const int point = point_of[static_cast<std::size_t>(landmark)];
      if (point == kNone) continue;
      visit(pose, static_cast<std::size_t>(point), keyframe.features->keypoints[k]);
    }
  }
}

std::vector<Pose> pose_matrices(const BundleProblem& problem) {
  std::vector<Pose> poses;
  poses.reserve(problem.poses.size());
  for (const PoseBlock& block : problem.poses) poses.push_back(pose_from_block(block));
  return poses;
}

double chi2_of(const BundleProblem& problem, const std::vector<Pose>& poses,
               const BundleObservation& seen) {
  return seen.term.chi2(poses[static_cast<std::size_t>(seen.pose)] *
                            problem.points[static_cast<std::size_t>(seen.point)],
                        problem.focal_factor);
}

bool is_determined(int observations, bool depth) { return observations >= (depth ? 1 : 2); }

std::unique_ptr<ceres::CostFunction> make_cost(const ReprojectionTerm& term, bool refine_focal) {
  if (refine_focal) {
    if (term.rows() == 3) return std::make_unique<FocalReprojectionCost<3>>(term);
    return std::make_unique<FocalReprojectionCost<2>>(term);
  }
  if (term.rows() == 3) return std::make_unique<ReprojectionCost<3>>(term);
  return std::make_unique<ReprojectionCost<2>>(term);
}

ceres::Solver::Options solver_options(const BundleSolve& solve, int free_keyframes) {
  ceres::Solver::Options options;
  options.max_num_iterations = solve.iterations;
  options.function_tolerance = solve.function_tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.linear_solver_type =
      free_keyframes <= kMaxDenseKeyframes ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  // Eigen's own solvers: the BLAS behind the others differs from machine to machine.
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  return options;
}

std::unique_ptr<ceres::LossFunction> make_loss(const BundleProblem& problem,
                                               const BundleSolve& solve, bool depth) {
  const double width =
      std::sqrt(bend_of(solve.loss, solve.spread, problem.threshold(depth), depth));
  switch (solve.loss) {
    case RobustLoss::kSquared:
      return nullptr;
    case RobustLoss::kHuber:
      return std::make_unique<ceres::HuberLoss>(width);
    case RobustLoss::kCauchy:
      break;
  }
  return std::make_unique<ceres::ScaledLoss>(new ceres::CauchyLoss(width), solve.spread.gain,
                                             ceres::TAKE_OWNERSHIP);
}

}  // namespace

bool BundleProblem::has_depth() const {
  return std::any_of(observations.begin(), observations.end(),
                     [](const BundleObservation& seen) { return seen.term.rows() == 3; });
}

double BundleProblem::chi2(const BundleObservation& seen) const {
  return seen.term.chi2(pose_from_block(poses[static_cast<std::size_t>(seen.pose)]) *
                            points[static_cast<std::size_t>(seen.point)],
                        focal_factor);
}

BundleProblem collect_bundle(const Map& map, const Camera& camera,
                             const std::vector<KeyframeId>& keyframes,
                             const std::vector<char>& fixed,
                             const std::vector<LandmarkId>& landmarks,
                             const BundleOptions& options) {
  BundleProblem problem;
  problem.keyframes = keyframes;
  problem.fixed = fixed;
  problem.chi2_mono = options.chi2_mono;
  problem.chi2_depth = options.chi2_depth;
  problem.poses.reserve(keyframes.size());
  for (const KeyframeId id : keyframes) {
    problem.poses.push_back(block_from_pose(map.keyframes.at(id).cam_from_world));
  }
  std::vector<double> sigma_px;
  sigma_px.reserve(static_cast<std::size_t>(options.levels.levels));
  for (int octave = 0; octave < options.levels.levels; ++octave) {
    sigma_px.push_back(options.levels.sigma_px(octave));
  }
  const std::vector<int> point_of = index_by_id(landmarks, map.landmarks.next_id());
  std::vector<int> sights(landmarks.size(), 0);
  std::vector<char> depth(landmarks.size(), 0);
  visit_sights(map, keyframes, point_of,
               [&](std::size_t, std::size_t point, const Keypoint& keypoint) {
                 ++sights[point];
                 if (keypoint.depth > 0.0F) depth[point] = 1;
               });
  // Where each landmark's sights go; one that is not determined has no place.
  std::vector<int> point_index(landmarks.size(), kNone);
  std::vector<std::size_t> next(landmarks.size(), 0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!is_determined(sights[i], depth[i] != 0)) continue;
    point_index[i] = static_cast<int>(problem.points.size());
    next[i] = count;
    count += static_cast<std::size_t>(sights[i]);
    problem.landmarks.push_back(landmarks[i]);
    problem.points.push_back(map.landmarks.at(landmarks[i]).position);
  }
  problem.observations.assign(
      count,
      {0, 0, ReprojectionTerm(camera, options.depth_baseline_m, {0.0, 0.0}, 1.0, 0.0), true});
  visit_sights(map, keyframes, point_of,
               [&](std::size_t pose, std::size_t point, const Keypoint& keypoint) {
                 if (point_index[point] == kNone) return;
                 const auto octave = static_cast<std::size_t>(
                     std::clamp(keypoint.octave, 0, static_cast<int>(sigma_px.size()) - 1));
                 BundleObservation& seen = problem.observations[next[point]++];
                 seen.pose = static_cast<int>(pose);
                 seen.point = point_index[point];
                 seen.term.pixel = keypoint.pixel.cast<double>();
                 seen.term.inverse_sigma = 1.0 / sigma_px[octave];
                 if (keypoint.depth > 0.0F) seen.term.inverse_depth = 1.0 / keypoint.depth;
               });
  return problem;
}

BundleProblem collect_whole_map(const Map& map, const Camera& camera,
                                const BundleOptions& options) {
  std::vector<KeyframeId> keyframes;
  for (const Keyframe& keyframe : map.keyframes) keyframes.push_back(keyframe.id);
  std::vector<LandmarkId> landmarks;
  for (const Landmark& landmark : map.landmarks) landmarks.push_back(landmark.id);
  std::vector<char> fixed(keyframes.size(), 0);
  fixed.front() = 1;
  return collect_bundle(map, camera, keyframes, fixed, landmarks, options);
}

ResidualSpread measure_spread(const BundleProblem& problem) {
  const std::vector<Pose> poses = pose_matrices(problem);
  std::vector<double> mono, depth;
  for (const BundleObservation& seen : problem.observations) {
    if (!seen.active) continue;
    (seen.term.rows() == 3 ? depth : mono).push_back(chi2_of(problem, poses, seen));
  }
  const std::size_t count = mono.size() + depth.size();
  ResidualSpread result{spread_of(mono, 2), spread_of(depth, 3), 1.0};
  double curvature = 0.0;
  const auto add = [&](const std::vector<double>& all, bool is_depth) {
    const double width2 =
        bend_of(RobustLoss::kCauchy, result, problem.threshold(is_depth), is_depth);
    // Over all directions, that of a residual of two coordinates is the square of its weight.
    for (const double chi2 : all) {
      const double weight = robust_weight(RobustLoss::kCauchy, chi2, width2);
      curvature += weight * weight;
    }
  };
  add(mono, false);
  add(depth, true);
  if (curvature > 0.0) result.gain = static_cast<double>(count) / curvature;
  return result;
}

double loss_of(const BundleProblem& problem, const BundleSolve& solve) {
  const std::unique_ptr<ceres::LossFunction> loss_mono = make_loss(problem, solve, false);
  const std::unique_ptr<ceres::LossFunction> loss_depth = make_loss(problem, solve, true);
  const std::vector<Pose> poses = pose_matrices(problem);
  double sum = 0.0;
  for (const BundleObservation& seen : problem.observations) {
    if (!seen.active) continue;
    const double chi2 = chi2_of(problem, poses, seen);
    const ceres::LossFunction* loss = seen.term.rows() == 3 ? loss_depth.get() : loss_mono.get();
    std::array<double, 3> value = {chi2, 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(chi2, value.data());
    sum += value[0];
  }
  return sum;
}

int solve_bundle(BundleProblem& problem, const BundleSolve& solve) {
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.disable_all_safety_checks = true;
  const std::unique_ptr<ceres::LossFunction> loss_mono = make_loss(problem, solve, false);
  const std::unique_ptr<ceres::LossFunction> loss_depth = make_loss(problem, solve, true);
  PoseManifold manifold;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs;
  costs.reserve(problem.observations.size());
  ceres::Problem ceres_problem(ownership);

  std::vector<char> pose_used(problem.poses.size(), 0);
  std::vector<char> point_used(problem.points.size(), 0);
  for (const BundleObservation& seen : problem.observations) {
    if (!seen.active) continue;
    pose_used[static_cast<std::size_t>(seen.pose)] = 1;
    point_used[static_cast<std::size_t>(seen.point)] = 1;
    costs.push_back(make_cost(seen.term, solve.refine_focal));
    ceres::LossFunction* loss = seen.term.rows() == 3 ? loss_depth.get() : loss_mono.get();
    double* pose = problem.poses[static_cast<std::size_t>(seen.pose)].data();
    double* point = problem.points[static_cast<std::size_t>(seen.point)].data();
    if (solve.refine_focal) {
      ceres_problem.AddResidualBlock(costs.back().get(), loss, pose, point, &problem.focal_factor);
    } else {
      ceres_problem.AddResidualBlock(costs.back().get(), loss, pose, point);
    }
  }
  if (costs.empty()) return 0;
  const auto free_keyframes = std::count(problem.fixed.begin(), problem.fixed.end(), 0);
  ceres::Solver::Options options = solver_options(solve, static_cast<int>(free_keyframes));
  ceres::ParameterBlockOrdering& ordering = *options.linear_solver_ordering;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (point_used[i]) ordering.AddElementToGroup(problem.points[i].data(), kPointGroup);
  }
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (!pose_used[i]) continue;
    ordering.AddElementToGroup(problem.poses[i].data(), kPoseGroup);
    ceres_problem.SetManifold(problem.poses[i].data(), &manifold);
    if (problem.fixed[i]) ceres_problem.SetParameterBlockConstant(problem.poses[i].data());
  }
  FocalPriorCost focal_prior(solve.focal_sigma);
  if (solve.refine_focal) {
    ordering.AddElementToGroup(&problem.focal_factor, kFocalGroup);
    ceres_problem.AddResidualBlock(&focal_prior, nullptr, &problem.focal_factor);
  }
  if (solve.extend) solve.extend(ceres_problem, ordering);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  return summary.num_successful_steps + summary.num_unsuccessful_steps;
}

int deactivate_outliers(BundleProblem& problem, double gate) {
  std::vector<int> left(problem.points.size(), 0);
  std::vector<char> depth(problem.points.size(), 0);
  const std::vector<Pose> poses = pose_matrices(problem);
  for (BundleObservation& seen : problem.observations) {
    const double chi2 = chi2_of(problem, poses, seen);
    seen.active = std::isfinite(chi2) && chi2 <= gate * problem.threshold(seen);
    if (!seen.active) continue;
    ++left[static_cast<std::size_t>(seen.point)];
    if (seen.term.rows() == 3) depth[static_cast<std::size_t>(seen.point)] = 1;
  }
  int inactive = 0;
  for (BundleObservation& seen : problem.observations) {
    const auto point = static_cast<std::size_t>(seen.point);
    seen.active = seen.active && is_determined(left[point], depth[point] != 0);
    inactive += !seen.active;
  }
  return inactive;
}

double reprojection_rms_px(const BundleProblem& problem) {
  double sum = 0.0;
  int count = 0;
  const std::vector<Pose> poses = pose_matrices(problem);
  for (const BundleObservation& seen : problem.observations) {
    if (!seen.active) continue;
    sum += seen.term.squared_error_px(poses[static_cast<std::size_t>(seen.pose)] *
                                          problem.points[static_cast<std::size_t>(seen.point)],
                                      problem.focal_factor);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

double keyframe_distance(const BundleProblem& problem, int anchor, int other) {
  const auto centre = [&](int index) -> Eigen::Vector3d {
    return pose_from_block(problem.poses[static_cast<std::size_t>(index)]).inverse().translation();
  };
  return (centre(anchor) - centre(other)).norm();
}

double restore_distance(BundleProblem& problem, int anchor, int other, double distance) {
  const double now = keyframe_distance(problem, anchor, other);
  if (!(now > kMinDistance) || !(distance > kMinDistance)) return 1.0;
  const double factor = distance / now;
  const Eigen::Vector3d centre =
      pose_from_block(problem.poses[static_cast<std::size_t>(anchor)]).inverse().translation();
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (problem.fixed[i]) continue;
    // t' = s t + (s - 1) R c keeps R (c + s (x - c)) + t' = s (R x + t).
    Pose pose = pose_from_block(problem.poses[i]);
    pose.translation() =
        factor * pose.translation() + (factor - 1.0) * (pose.linear() * centre).eval();
    problem.poses[i] = block_from_pose(pose);
  }
  for (Eigen::Vector3d& point : problem.points) point = centre + factor * (point - centre);
  return factor;
}

void write_back(const BundleProblem& problem, Map& map) {
  for (std::size_t i = 0; i < problem.keyframes.size(); ++i) {
    if (problem.fixed[i]) continue;
    map.keyframes.at(problem.keyframes[i]).cam_from_world = pose_from_block(problem.poses[i]);
  }
  for (std::size_t i = 0; i < problem.landmarks.size(); ++i) {
    map.landmarks.at(problem.landmarks[i]).position = problem.points[i];
  }
}

int remove_inactive(const BundleProblem& problem, Map& map) {
  int removed = 0;
  for (const BundleObservation& seen : problem.observations) {
    if (seen.active) continue;
    const LandmarkId landmark = problem.landmarks[static_cast<std::size_t>(seen.point)];
    if (map.landmarks.contains(landmark)) {
      map.remove_observation(landmark, problem.keyframes[static_cast<std::size_t>(seen.pose)]);
    }
    ++removed;
  }
  return removed;
}

}  // namespace planecast::slam
