#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "planes_world.h"
#include "slam/fitting/graph_cut_ransac.h"
#include "slam/fitting/plane_model.h"
#include "slam/fitting/samplers.h"
#include "slam/fitting/sequential.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;

constexpr double kEps = 0.02;

RansacResult<PlaneEquation> fit(const PlanePoints& points, bool graph_cut, std::uint64_t seed) {
  const PlaneModel model(points);
  UniformSampler sampler(points.size(), PlaneModel::kSampleSize);
  RansacOptions options;
  options.threshold = kEps;
  options.max_rms = 0.5 * kEps;
  options.lambda = 0.6;
  options.graph_cut = graph_cut;
  options.seed = seed;
  const auto neighbours = radius_neighbours(points.positions, 2.0 * kEps);
  return GraphCutRansac(model, sampler, neighbours, options).run();
}

/// A mask of 200 points of z = 0, a fifth of which leaked from a plane that meets it at the mask's
/// edge.
PlanePoints leaked_mask(std::mt19937& generator, double noise) {
  PlanePoints points;
  points.positions = strew(generator, 160, {0, 0, 0}, {0.6, 0, 0}, {0, 0.5, 0}, noise);
  const auto leak = strew(generator, 40, {0.6, 0, 0}, {0.03, 0, 0.15}, {0, 0.5, 0}, noise);
  points.positions.insert(points.positions.end(), leak.begin(), leak.end());
  return points;
}

TEST(PlaneFitting, LeakedMasksAreFittedBetterThanByPlainRansac) {
  auto generator = test_generator();
  double with_cut = 0.0;
  double plain = 0.0;
  int leaked_with_cut = 0;
  int leaked_plain = 0;
  constexpr int kTrials = 50;
  for (int trial = 0; trial < kTrials; ++trial) {
    const PlanePoints points = leaked_mask(generator, 0.4 * kEps);
    const auto a = fit(points, true, static_cast<std::uint64_t>(trial));
    const auto b = fit(points, false, static_cast<std::uint64_t>(trial));
    ASSERT_TRUE(a.accepted);
    ASSERT_TRUE(b.accepted);
    with_cut += std::acos(std::min(1.0, std::abs(a.model.normal.z()))) / kTrials;
    plain += std::acos(std::min(1.0, std::abs(b.model.normal.z()))) / kTrials;
    leaked_with_cut += std::count(a.inlier.begin() + 160, a.inlier.end(), 1);
    leaked_plain += std::count(b.inlier.begin() + 160, b.inlier.end(), 1);
  }
  EXPECT_LT(with_cut, plain);
  EXPECT_LT(leaked_with_cut, leaked_plain);
  // 160 points of noise s over 0.6 x 0.5: the slopes' errors are s sqrt(12 / 160) / 0.6 and / 0.5.
  // The leak may at most double them.
  const double noise_only = 0.4 * kEps * std::sqrt(12.0 / 160.0) * std::hypot(1 / 0.6, 1 / 0.5);
  EXPECT_LT(with_cut, 2.0 * noise_only);
}

TEST(PlaneFitting, TwoRunsAreIdentical) {
  auto generator = test_generator();
  const PlanePoints points = leaked_mask(generator, 0.4 * kEps);
  const auto a = fit(points, true, 7);
  const auto b = fit(points, true, 7);
  EXPECT_EQ(a.model.normal, b.model.normal);
  EXPECT_EQ(a.inlier, b.inlier);
  EXPECT_EQ(a.samples, b.samples);
}

TEST(PlaneFitting, ScatteredPointsAreNotAccepted) {
  auto generator = test_generator();
  PlanePoints points;
  points.positions = strew(generator, 40, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5);
  EXPECT_FALSE(fit(points, true, 1).accepted);
  points.positions.assign(40, Vector3d(1, 2, 3));
  EXPECT_FALSE(fit(points, true, 1).found);
  points.positions.clear();
  EXPECT_FALSE(fit(points, true, 1).found);
}

TEST(PlaneFitting, PointsSeenFromBehindAreNoInliers) {
  auto generator = test_generator();
  PlanePoints points;
  points.positions = strew(generator, 200, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.003);
  for (int i = 0; i < 200; ++i)
    points.view_from.push_back(i < 120 ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ()));
  const auto result = fit(points, true, 1);
  ASSERT_TRUE(result.accepted);
  EXPECT_GT(result.model.normal.z(), 0.99);
  EXPECT_EQ(std::count(result.inlier.begin() + 120, result.inlier.end(), 1), 0);
  EXPECT_GT(result.num_inliers, 110);
}

TEST(PlaneFitting, WideBandsTakeNoisyPoints) {
  auto generator = test_generator();
  PlanePoints points;
  points.positions = strew(generator, 100, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.003);
  const auto noisy = strew(generator, 100, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.02);
  points.positions.insert(points.positions.end(), noisy.begin(), noisy.end());
  EXPECT_LT(fit(points, true, 1).num_inliers, 185);
  points.band.assign(100, 1.0);
  points.band.resize(200, 3.0);
  const auto result = fit(points, true, 1);
  ASSERT_TRUE(result.accepted);
  EXPECT_GT(result.num_inliers, 195);
}

TEST(Sequential, GroupsComeLargestFirstAndTiesByLabel) {
  const auto groups = groups_by_label({3, 1, 0, 2, 3, 1, 3, 2, 9}, 2);
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0], (std::vector<int>{0, 4, 6}));
  EXPECT_EQ(groups[1], (std::vector<int>{1, 5}));
  EXPECT_EQ(groups[2], (std::vector<int>{3, 7}));
}

TEST(Sequential, ConsumedPointsLeaveThePool) {
  std::vector<std::size_t> sizes;
  fit_sequentially({0, 1, 2, 3, 4, 5, 6}, 3, 10, [&](const std::vector<int>& pool) {
    sizes.push_back(pool.size());
    return std::vector<int>{pool[0], pool[2]};
  });
  EXPECT_EQ(sizes, (std::vector<std::size_t>{7, 5, 3}));
}

}  // namespace
}  // namespace planecast::slam
