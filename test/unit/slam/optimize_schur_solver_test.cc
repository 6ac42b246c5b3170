#include "slam/optimize/schur_solver.h"

#include <gtest/gtest.h>

#include "test/unit/slam/synthetic_map.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

double total_chi2(const BundleProblem& problem) {
  double sum = 0.0;
  for (const BundleObservation& seen : problem.observations) {
    if (seen.active) sum += problem.chi2(seen);
  }
  return sum;
}

/// A problem whose first two keyframes are fixed, perturbed.
BundleProblem perturbed_problem(bool depth, double outlier_share, Random& random) {
  MapOptions options;
  options.depth = depth;
  options.noise_px = 0.5;
  options.outlier_share = outlier_share;
  MapScene scene = make_box_map(options, random);
  perturb(scene.map, 2, 0.01, 0.03, 0.05, random);
  BundleProblem problem = collect_whole_map(scene.map, scene.camera, {});
  problem.fixed[1] = 1;
  return problem;
}

/// The same with 5 % outliers, most of which are told: Cauchy's loss has one minimum only from near
/// by.
BundleProblem problem_near_minimum(bool depth, double tolerance, Random& random) {
  BundleProblem problem = perturbed_problem(depth, 0.05, random);
  solve_window(problem, {30, RobustLoss::kHuber, tolerance});
  deactivate_outliers(problem);
  return problem;
}

TEST(SolveWindow, ReachesTheMinimumThatCeresDoes) {
  Random random(seed_of("SolveWindow.ReachesTheMinimumThatCeresDoes"));
  for (const bool depth : {false, true}) {
    BundleProblem ours = perturbed_problem(depth, 0.0, random);
    BundleProblem theirs = ours;
    const double before = total_chi2(ours);
    solve_window(ours, {30, RobustLoss::kSquared, 1e-9});
    BundleSolve solve;
    solve.iterations = 30;
    solve.loss = RobustLoss::kSquared;
    solve.function_tolerance = 1e-9;
    solve_bundle(theirs, solve);
    EXPECT_LT(total_chi2(ours), 0.1 * before);
    // Both end within their tolerance of one minimum.
    EXPECT_NEAR(total_chi2(ours) / total_chi2(theirs), 1.0, 1e-5) << "depth " << depth;
    for (std::size_t i = 0; i < ours.poses.size(); ++i) {
      for (std::size_t k = 0; k < 7; ++k) {
        // Signs of a quaternion are free.
        EXPECT_NEAR(std::abs(ours.poses[i][k]), std::abs(theirs.poses[i][k]), 1e-4);
      }
    }
  }
}

TEST(SolveWindow, WeighsSightsAsCeresDoes) {
  Random random(seed_of("SolveWindow.WeighsSightsAsCeresDoes"));
  for (const bool depth : {false, true}) {
    BundleProblem ours = problem_near_minimum(depth, 1e-9, random);
    BundleProblem theirs = ours;
    BundleSolve solve;
    solve.iterations = 30;
    solve.loss = RobustLoss::kCauchy;
    solve.spread = measure_spread(ours);
    solve.function_tolerance = 1e-9;
    const double before = loss_of(ours, solve);
    solve_window(ours, {30, RobustLoss::kCauchy, 1e-9, solve.spread});
    solve_bundle(theirs, solve);
    EXPECT_LT(loss_of(ours, solve), before);
    EXPECT_NEAR(loss_of(ours, solve) / loss_of(theirs, solve), 1.0, 1e-5) << "depth " << depth;
  }
}

TEST(SolveWindow, EndsWherePosesHaveSettled) {
  Random random(seed_of("SolveWindow.EndsWherePosesHaveSettled"));
  for (const bool depth : {false, true}) {
    const BundleProblem start = problem_near_minimum(depth, 1e-1, random);
    const ResidualSpread spread = measure_spread(start);
    BundleProblem minimum = start;
    BundleProblem settled = start;
    const int all = solve_window(minimum, {50, RobustLoss::kCauchy, 1e-12, spread});
    EXPECT_LT(solve_window(settled, {50, RobustLoss::kCauchy, 1e-12, spread, 0.02}), all);
    const auto squared_distance = [&](const BundleProblem& problem) {
      double sum = 0.0;
      for (std::size_t i = 0; i < problem.poses.size(); ++i) {
        sum += (pose_from_block(problem.poses[i]).inverse().translation() -
                pose_from_block(minimum.poses[i]).inverse().translation())
                   .squaredNorm();
      }
      return sum;
    };
    EXPECT_LT(squared_distance(settled), 0.05 * squared_distance(start)) << "depth " << depth;
  }
}

TEST(SolveWindow, IsRobustAgainstOutliers) {
  Random random(seed_of("SolveWindow.IsRobustAgainstOutliers"));
  BundleProblem ours = perturbed_problem(false, 0.1, random);
  BundleProblem theirs = ours;
  solve_window(ours, {30, RobustLoss::kHuber, 1e-9});
  BundleSolve solve;
  solve.iterations = 30;
  solve.function_tolerance = 1e-9;
  solve_bundle(theirs, solve);
  // Outliers in front of two cameras leave shallow minima beside one another: what is told apart is
  // the share of observations that agree.
  const int left_ours = deactivate_outliers(ours);
  const int left_theirs = deactivate_outliers(theirs);
  EXPECT_NEAR(left_ours, left_theirs, 0.02 * static_cast<double>(ours.observations.size()));
}

TEST(SolveWindow, HoldsWhatIsFixed) {
  Random random(seed_of("SolveWindow.HoldsWhatIsFixed"));
  BundleProblem problem = perturbed_problem(false, 0.0, random);
  const BundleProblem before = problem;
  solve_window(problem, {10, RobustLoss::kHuber, 1e-6});
  EXPECT_EQ(problem.poses[0], before.poses[0]);
  EXPECT_EQ(problem.poses[1], before.poses[1]);
  EXPECT_NE(problem.poses[2], before.poses[2]);
}

TEST(SolveWindow, MovesPointsAloneWhereEveryPoseIsFixed) {
  Random random(seed_of("SolveWindow.MovesPointsAloneWhereEveryPoseIsFixed"));
  BundleProblem problem = perturbed_problem(false, 0.0, random);
  for (char& fixed : problem.fixed) fixed = 1;
  const double before = total_chi2(problem);
  EXPECT_GT(solve_window(problem, {10, RobustLoss::kSquared, 1e-6}), 0);
  EXPECT_LT(total_chi2(problem), before);
}

}  // namespace
}  // namespace planecast::slam
