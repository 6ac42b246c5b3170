#include "slam/geometry/pnp.h"

#include <gtest/gtest.h>

#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

struct Problem {
  Camera camera = synthetic::camera();
  Pose truth = pose_at({0.5, -0.3, 0.8}, {0.15, -0.1, 0.3});
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> sigma_px;
  std::vector<char> is_outlier;
};

Problem make_problem(int count, double noise_px, double outlier_share, Random& random) {
  Problem problem;
  problem.points = box_points(count, random);
  for (const Eigen::Vector3d& point : problem.points) {
    const double sigma = std::pow(1.2, random.below(4));
    const bool outlier = random.uniform() < outlier_share;
    problem.sigma_px.push_back(sigma);
    problem.is_outlier.push_back(outlier);
    problem.pixels.push_back(
        outlier ? random_pixel(problem.camera, random)
                : noisy(problem.camera.project(problem.truth * point), noise_px * sigma, random));
  }
  return problem;
}

TEST(SolvePnp, ExactPairsGiveTheExactPose) {
  Random random(seed_of("SolvePnp.ExactPairsGiveTheExactPose"));
  for (const double fy : {520.0, -480.0}) {
    Problem problem = make_problem(30, 0.0, 0.0, random);
    problem.camera.fy = fy;
    for (std::size_t i = 0; i < problem.points.size(); ++i) {
      problem.pixels[i] = problem.camera.project(problem.truth * problem.points[i]);
    }
    const auto result =
        solve_pnp(problem.camera, problem.points, problem.pixels, problem.sigma_px, {});
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->cam_from_world.isApprox(problem.truth, 1e-9));
    EXPECT_EQ(result->num_inliers, 30);
  }
}

TEST(SolvePnp, FindsThePoseAmongSixtyPercentOutliers) {
  Random random(seed_of("SolvePnp.FindsThePoseAmongSixtyPercentOutliers"));
  const Problem problem = make_problem(200, 1.0, 0.6, random);
  const auto result =
      solve_pnp(problem.camera, problem.points, problem.pixels, problem.sigma_px, {});
  ASSERT_TRUE(result);
  // 80 inliers: one pixel of noise (0.11 degrees) over sqrt(80), several times that when shared
  // with the translation.
  EXPECT_LT(rotation_error_deg(result->cam_from_world, problem.truth), 0.3);
  EXPECT_LT((result->cam_from_world.translation() - problem.truth.translation()).norm(), 0.03);
  int missed = 0, wrong = 0;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    missed += !problem.is_outlier[i] && !result->inlier[i];
    wrong += problem.is_outlier[i] && result->inlier[i];
  }
  EXPECT_LE(missed, 1);  // a gate of 4 sigma lets 0.03 % go
  EXPECT_LE(wrong, 1);
}

TEST(SolvePnp, RefusesNonsenseAndTooFewPairs) {
  Random random(seed_of("SolvePnp.RefusesNonsenseAndTooFewPairs"));
  const Problem nonsense = make_problem(60, 0.0, 1.0, random);
  EXPECT_FALSE(solve_pnp(nonsense.camera, nonsense.points, nonsense.pixels, nonsense.sigma_px, {}));
  const Problem few = make_problem(9, 0.0, 0.0, random);
  EXPECT_FALSE(solve_pnp(few.camera, few.points, few.pixels, few.sigma_px, {}));
  EXPECT_FALSE(solve_pnp(few.camera, {}, {}, {}, {}));
}

TEST(SolvePnp, SurvivesDegeneratePoints) {
  Random random(seed_of("SolvePnp.SurvivesDegeneratePoints"));
  Problem problem = make_problem(30, 0.0, 0.0, random);
  for (Eigen::Vector3d& point : problem.points) point = {0.0, 0.0, 4.0};
  const auto result =
      solve_pnp(problem.camera, problem.points, problem.pixels, problem.sigma_px, {});
  EXPECT_TRUE(!result || result->cam_from_world.matrix().allFinite());
}

TEST(SolvePnp, IsRepeatable) {
  Random random(seed_of("SolvePnp.IsRepeatable"));
  const Problem problem = make_problem(100, 1.0, 0.4, random);
  const auto first =
      solve_pnp(problem.camera, problem.points, problem.pixels, problem.sigma_px, {});
  const auto second =
      solve_pnp(problem.camera, problem.points, problem.pixels, problem.sigma_px, {});
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->cam_from_world.matrix(), second->cam_from_world.matrix());
  EXPECT_EQ(first->inlier, second->inlier);
}

}  // namespace
}  // namespace planecast::slam
