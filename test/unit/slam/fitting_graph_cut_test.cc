#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "planes_world.h"
#include "slam/fitting/graph_cut.h"
#include "slam/fitting/neighbourhood.h"

namespace planecast::slam {
namespace {

/// The best of all labellings by trying each.
double least_energy(const std::vector<double>& kernel, const std::vector<NeighbourPair>& pairs,
                    const PairOptions& options) {
  const int n = static_cast<int>(kernel.size());
  double best = HUGE_VAL;
  std::vector<char> inlier(kernel.size());
  for (int bits = 0; bits < (1 << n); ++bits) {
    for (int i = 0; i < n; ++i) inlier[i] = static_cast<char>((bits >> i) & 1);
    best = std::min(best, labelling_energy(kernel, pairs, options, inlier));
  }
  return best;
}

TEST(GraphCut, FindsTheLeastEnergyOfAllLabellings) {
  auto generator = test_generator();
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  GraphCut cut;
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 10;
    std::vector<double> kernel;
    std::vector<NeighbourPair> pairs;
    for (int i = 0; i < n; ++i)
      kernel.push_back(trial % 3 == 0 ? std::round(uniform(generator)) : uniform(generator));
    for (int a = 0; a < n; ++a) {
      for (int b = a + 1; b < n; ++b) {
        if (uniform(generator) < 0.3) pairs.push_back({a, b});
      }
    }
    const double lambda = trial % 2 == 0 ? 0.6 : 0.975;
    const PairOptions options{lambda, trial % 5 < 2};
    std::vector<char> inlier;
    cut.label(kernel, pairs, options, inlier);
    // Every cost is rounded to 2^-20 once per point and per end of a pair.
    const double rounding = std::ldexp(static_cast<double>(n + 4 * pairs.size()), -20);
    EXPECT_NEAR(labelling_energy(kernel, pairs, options, inlier),
                least_energy(kernel, pairs, options), rounding)
        << "trial " << trial;
  }
}

TEST(GraphCut, WithoutNeighboursTheKernelDecides) {
  std::vector<char> inlier;
  GraphCut().label({0.9, 0.5, 0.1}, {}, {0.6}, inlier);
  EXPECT_EQ(inlier, (std::vector<char>{1, 0, 0}));
}

/// Inliers of a plane over a square and, away from them, a tight cluster of gross outliers: of the
/// cluster nothing may be labelled inlier. The form of later implementations, which charges nothing
/// for two far points both labelled inlier, marks over 90 % of it.
class ClusteredOutliers : public ::testing::TestWithParam<std::tuple<double, bool>> {};

TEST_P(ClusteredOutliers, AreNotInliers) {
  auto generator = test_generator();
  const double eps = 0.02;
  std::vector<Eigen::Vector3d> points =
      strew(generator, 300, {0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, 0.3 * eps);
  // 0.1 above the plane: five thresholds away, and dense enough that all are neighbours of many.
  const auto cluster = strew(generator, 100, {0.2, 0.2, 0.1}, {0.1, 0, 0}, {0, 0.1, 0}, 0.3 * eps);
  points.insert(points.end(), cluster.begin(), cluster.end());
  std::vector<double> kernel;
  for (const Eigen::Vector3d& p : points) {
    kernel.push_back(std::exp(-p.z() * p.z() / (2.0 * eps * eps)));
  }
  for (const int max_neighbours : {kNearestNeighbours, kAllPairs}) {
    const auto pairs = radius_neighbours(points, 2.0 * eps, max_neighbours);
    ASSERT_GT(pairs.size(), 400U);
    std::vector<char> inlier;
    const auto& [lambda, by_contrast] = GetParam();
    GraphCut().label(kernel, pairs, {lambda, by_contrast}, inlier);
    EXPECT_EQ(std::accumulate(inlier.begin() + 300, inlier.end(), 0), 0);
    // At 0.3 eps noise a kernel under 0.5 would be a 3.9 sigma point.
    EXPECT_GE(std::accumulate(inlier.begin(), inlier.begin() + 300, 0), 298);
  }
}

INSTANTIATE_TEST_SUITE_P(Lambdas, ClusteredOutliers,
                         ::testing::Combine(::testing::Values(0.6, 0.975), ::testing::Bool()));

TEST(Neighbourhood, RadiusSearchFindsExactlyThePairsWithin) {
  auto generator = test_generator();
  const auto points = strew(generator, 60, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.2);
  const double radius = 0.3;
  std::vector<std::pair<int, int>> expected;
  for (int a = 0; a < 60; ++a) {
    for (int b = a + 1; b < 60; ++b) {
      if ((points[a] - points[b]).norm() < radius) expected.emplace_back(a, b);
    }
  }
  std::vector<std::pair<int, int>> found;
  for (const auto& pair : radius_neighbours(points, radius, kAllPairs))
    found.emplace_back(pair.a, pair.b);
  EXPECT_EQ(found, expected);
  EXPECT_TRUE(radius_neighbours({}, radius).empty());
}

TEST(Neighbourhood, GridLinksTheNearestThatShareBothCells) {
  auto generator = test_generator();
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<PointPair> pairs(400);
  for (PointPair& pair : pairs) {
    pair.ref = {640.0 * uniform(generator), 480.0 * uniform(generator)};
    pair.cur = pair.ref + Eigen::Vector2d(60.0 * uniform(generator), 0.0);
  }
  const auto cell = [](const Eigen::Vector2d& p) {
    return std::pair(std::clamp(static_cast<int>(p.x() / 80.0), 0, 7),
                     std::clamp(static_cast<int>(p.y() / 60.0), 0, 7));
  };
  GridOptions all;
  all.max_neighbours = kAllPairs;
  const auto everything = image_grid_neighbours(pairs, 640, 480, all);
  std::size_t expected = 0;
  for (std::size_t a = 0; a < pairs.size(); ++a) {
    for (std::size_t b = a + 1; b < pairs.size(); ++b) {
      expected +=
          cell(pairs[a].ref) == cell(pairs[b].ref) && cell(pairs[a].cur) == cell(pairs[b].cur);
    }
  }
  EXPECT_EQ(everything.size(), expected);
  GridOptions two;
  two.max_neighbours = 2;
  for (const auto& pair : image_grid_neighbours(pairs, 640, 480, two)) {
    int nearer_a = 0;
    int nearer_b = 0;
    const double d = (pairs[pair.a].ref - pairs[pair.b].ref).norm();
    for (const auto& other : everything) {
      const double length = (pairs[other.a].ref - pairs[other.b].ref).norm();
      nearer_a += (other.a == pair.a || other.b == pair.a) && length < d;
      nearer_b += (other.a == pair.b || other.b == pair.b) && length < d;
    }
    EXPECT_LT(std::min(nearer_a, nearer_b), 2);
  }
}

}  // namespace
}  // namespace planecast::slam
