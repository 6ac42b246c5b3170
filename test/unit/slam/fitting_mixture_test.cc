#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "planes_world.h"
#include "slam/fitting/plane_mixture.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;

constexpr double kEps = 0.04;
constexpr double kNoise = 0.004;

PlaneMixtureOptions mixture_options() {
  PlaneMixtureOptions options;
  options.reach = 2.0 * kEps;
  options.min_sigma = 0.1 * kEps;
  options.max_sigma = 0.5 * kEps;
  return options;
}

std::vector<int> all_of(const PlanePoints& points) {
  std::vector<int> indices(static_cast<std::size_t>(points.size()));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

/// 200 points of z = 0 and `things` strewn evenly over the 6 cm above it.
PlanePoints board_with_things(std::mt19937& generator, int things) {
  std::uniform_real_distribution<double> height(0.0, 0.06);
  PlanePoints points;
  points.positions = strew(generator, 200, {0, 0, 0}, {0.8, 0, 0}, {0, 0.6, 0}, kNoise);
  for (const Vector3d& foot : strew(generator, things, {0, 0, 0}, {0.8, 0, 0}, {0, 0.6, 0}, 0.0)) {
    points.positions.push_back(foot + Vector3d(0, 0, height(generator)));
  }
  return points;
}

TEST(PlaneMixture, FindsTheBoardUnderTheThingsOnIt) {
  auto generator = test_generator();
  for (int trial = 0; trial < 20; ++trial) {
    const PlanePoints points = board_with_things(generator, 150);
    const PlaneEquation start = fit_plane(points.positions)->plane;
    const PlaneEquation upright = start.normal.z() < 0.0 ? start.flipped() : start;
    const Vector3d centre(0.4, 0.3, 0.0);
    // Least squares goes to the mean height of all, 3 cm for three sevenths of the points.
    ASSERT_LT(upright.signed_distance(centre), -0.009);
    const auto mixture = fit_plane_mixture(points, all_of(points), upright, mixture_options());
    ASSERT_TRUE(mixture);
    // The board alone is known to 0.3 mm; things within its noise lift it by a fraction of that.
    EXPECT_LT(std::abs(mixture->plane.signed_distance(centre)), 0.4 * kNoise) << trial;
    EXPECT_GT(mixture->plane.normal.z(), std::cos(0.5 * M_PI / 180.0)) << trial;
    EXPECT_NEAR(mixture->sigma, kNoise, 0.4 * kNoise) << trial;
    EXPECT_GT(mixture->before, 0.2);
    EXPECT_LT(mixture->behind, 0.05);
  }
}

TEST(PlaneMixture, LeavesWhatStandsAloneWhereItIs) {
  auto generator = test_generator();
  double mean = 0.0;
  constexpr int kTrials = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    const PlanePoints points = board_with_things(generator, 0);
    const auto mixture =
        fit_plane_mixture(points, all_of(points), PlaneEquation(), mixture_options());
    ASSERT_TRUE(mixture);
    EXPECT_GT(mixture->share, 0.9);
    mean += mixture->plane.signed_distance({0.4, 0.3, 0.0}) / kTrials;
  }
  // Neither side is preferred: 4 standard deviations of the mean of 40 boards of 200 points.
  EXPECT_LT(std::abs(mean), 4.0 * kNoise / std::sqrt(200.0 * kTrials));
}

TEST(PlaneMixture, NeedsPointsInReach) {
  PlanePoints points;
  points.positions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  EXPECT_FALSE(fit_plane_mixture(points, all_of(points), PlaneEquation(), mixture_options()));
  EXPECT_FALSE(fit_plane_mixture(points, {}, PlaneEquation(), mixture_options()));
}

}  // namespace
}  // namespace planecast::slam
