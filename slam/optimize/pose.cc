#include "slam/optimize/pose.h"

#include <algorithm>
#include <cmath>

#include "slam/geometry/pose_system.h"
#include "slam/optimize/robust_loss.h"

namespace planecast::slam {
namespace {

/// Damping of the first step of a round: nearly Gauss-Newton, which a tracked frame's start allows.
constexpr double kInitialDamping = 1e-6;
constexpr double kMaxDamping = 1e3;
/// A round ends when a step lowers the cost by less than this share.
constexpr double kCostTolerance = 1e-5;
constexpr int kMinObservations = 3;
/// A point behind the camera counts as a residual of this many times the threshold, without
/// direction.
constexpr double kBehindFactor = 100.0;

struct Residual {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< u, v, disparity; over sigma
  int rows = 2;
  double chi2 = 0.0;
  double threshold = 0.0;
};

struct PoseLoss {
  RobustLoss loss = RobustLoss::kSquared;
  ResidualSpread spread;  ///< for Cauchy

  double width2(const Residual& residual) const {
    return bend_of(loss, spread, residual.threshold, residual.rows == 3);
  }
};

class PoseProblem {
 public:
  PoseProblem(const Camera& camera, const std::vector<PoseObservation>& observations,
              const PoseOptions& options)
      : camera_(camera),
        observations_(observations),
        options_(options),
        baseline_fx_(options.depth_baseline_m * std::abs(camera.fx)) {}

  /// Normal equations over the active observations, cost included.
  PoseSystem linearise(const Pose& pose, const std::vector<char>& active,
                       const PoseLoss& loss) const {
    PoseSystem system;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (!active[i]) continue;
      const PoseObservation& seen = observations_[i];
      const Eigen::Vector3d point = pose * seen.point_world;
      const Residual residual = evaluate(seen, point);
      system.cost += robust_cost(loss.loss, residual.chi2, loss.width2(residual));
      if (!(point.z() > 0.0)) continue;
      add(system, point, residual, seen.sigma_px,
          robust_weight(loss.loss, residual.chi2, loss.width2(residual)));
    }
    return system;
  }

  /// Marks the observations that pass their chi2 test; returns whether any mark changed.
  bool classify(const Pose& pose, PoseResult& result) const {
    bool changed = false;
    double chi2_sum = 0.0;
    int rows = 0;
    result.num_inliers = 0;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const Residual residual = evaluate(observations_[i], pose * observations_[i].point_world);
      const char passes = residual.chi2 <= residual.threshold;
      changed = changed || passes != result.inlier[i];
      result.inlier[i] = passes;
      if (!passes) continue;
      ++result.num_inliers;
      chi2_sum += residual.chi2;
      rows += residual.rows;
    }
    result.rms = rows > 0 ? std::sqrt(chi2_sum / rows) : 0.0;
    return changed;
  }

  ResidualSpread spread(const Pose& pose, const std::vector<char>& active) const {
    std::vector<double> mono, depth;
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      if (!active[i]) continue;
      const Residual residual = evaluate(observations_[i], pose * observations_[i].point_world);
      (residual.rows == 3 ? depth : mono).push_back(residual.chi2);
    }
    return {spread_of(mono, 2), spread_of(depth, 3), 1.0};
  }

 private:
  Residual evaluate(const PoseObservation& seen, const Eigen::Vector3d& point_cam) const {
    Residual residual;
    residual.rows = seen.depth > 0.0 ? 3 : 2;
    residual.threshold = seen.depth > 0.0 ? options_.chi2_depth : options_.chi2_mono;
    if (!(point_cam.z() > 0.0)) {
      residual.chi2 = kBehindFactor * residual.threshold;
      return residual;
    }
    residual.value.head<2>() = camera_.project(point_cam) - seen.pixel;
    if (seen.depth > 0.0) {
      residual.value.z() = baseline_fx_ * (1.0 / point_cam.z() - 1.0 / seen.depth);
    }
    residual.value /= seen.sigma_px;
    residual.chi2 = residual.value.squaredNorm();
    return residual;
  }

  void add(PoseSystem& system, const Eigen::Vector3d& point, const Residual& residual,
           double sigma_px, double weight) const {
    const double inverse_z = 1.0 / point.z();
    const double scale = inverse_z / sigma_px;
    const double fx = camera_.fx * scale;
    const double fy = camera_.fy * scale;
    system.add(point, {fx, 0.0, -fx * point.x() * inverse_z}, residual.value.x(), weight);
    system.add(point, {0.0, fy, -fy * point.y() * inverse_z}, residual.value.y(), weight);
    if (residual.rows == 3) {
      system.add(point, {0.0, 0.0, -baseline_fx_ * scale * inverse_z}, residual.value.z(), weight);
    }
  }

  const Camera& camera_;
  const std::vector<PoseObservation>& observations_;
  const PoseOptions& options_;
  double baseline_fx_;
};

/// Levenberg-Marquardt over a fixed set of observations.
Pose minimise(const PoseProblem& problem, const Pose& initial, const std::vector<char>& active,
              const PoseLoss& loss, int iterations) {
  Pose pose = initial;
  PoseSystem system = problem.linearise(pose, active, loss);
  double damping = kInitialDamping;
  for (int i = 0; i < iterations && damping < kMaxDamping; ++i) {
    const PoseStep step = system.solve(damping);
    if (!step.allFinite()) break;
    const Pose candidate = stepped(pose, step);
    const PoseSystem next = problem.linearise(candidate, active, loss);
    if (!(next.cost < system.cost)) {
      // Nothing left to gain, or too bold a step.
      if (next.cost <= system.cost * (1.0 + kCostTolerance)) break;
      damping = std::max(10.0 * damping, 1e-3);
      continue;
    }
    const bool converged = system.cost - next.cost < kCostTolerance * system.cost;
    pose = candidate;
    system = next;
    damping *= 0.1;
    if (converged) break;
  }
  return pose;
}

}  // namespace

PoseResult optimize_pose(const Camera& camera, const Pose& initial_cam_from_world,
                         const std::vector<PoseObservation>& observations,
                         const PoseOptions& options) {
  const PoseProblem problem(camera, observations, options);
  PoseResult result;
  result.cam_from_world = initial_cam_from_world;
  result.inlier.assign(observations.size(), 1);
  result.num_inliers = static_cast<int>(observations.size());
  for (int round = 0; round < options.rounds; ++round) {
    if (result.num_inliers < kMinObservations) break;
    const bool robust = round < options.rounds / 2;
    const PoseLoss loss{robust ? RobustLoss::kHuber : RobustLoss::kSquared, {}};
    result.cam_from_world =
        minimise(problem, result.cam_from_world, result.inlier, loss, options.iterations);
    const bool changed = problem.classify(result.cam_from_world, result);
    // Another round over the same observations would end where this one did.
    if (!robust && !changed) break;
  }
  if (options.weigh && result.num_inliers >= kMinObservations) {
    const PoseLoss loss{RobustLoss::kCauchy, problem.spread(result.cam_from_world, result.inlier)};
    // Sights that vary as much as their sigmas say leave nothing to tell apart within the gate.
    constexpr double kAsTheirSigmas = 0.5;
    if (std::min(loss.spread.mono, loss.spread.depth) < kAsTheirSigmas) {
      result.cam_from_world =
          minimise(problem, result.cam_from_world, result.inlier, loss, options.iterations);
      problem.classify(result.cam_from_world, result);
    }
  }
  result.information = problem.linearise(result.cam_from_world, result.inlier, {}).hessian;
  return result;
}

}  // namespace planecast::slam
