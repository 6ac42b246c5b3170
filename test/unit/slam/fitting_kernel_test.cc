#include "slam/fitting/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace planecast::slam {
namespace {

constexpr double kThreshold = 2.0;

/// Squared distances from 0 to past the background's reach, more than a block of them.
std::vector<double> squared_distances() {
  std::vector<double> squared;
  for (int i = 0; i < 1000; ++i) squared.push_back(std::pow(0.0071 * i, 2));
  return squared;
}

TEST(Kernel, IsTheGaussianWithinItsReach) {
  const std::vector<double> squared = squared_distances();
  const KernelOptions options{.threshold = kThreshold, .reach = 2.0};
  std::vector<double> k(squared.size());
  kernels(squared.data(), static_cast<int>(squared.size()), options, k.data());
  EXPECT_EQ(k[0], 1.0);
  for (std::size_t i = 0; i < squared.size(); ++i) {
    const bool far = std::sqrt(squared[i]) >= 2.0 * kThreshold;
    const double expected = far ? 0.0 : std::exp(-squared[i] / (2.0 * kThreshold * kThreshold));
    EXPECT_NEAR(k[i], expected, 3e-6) << std::sqrt(squared[i]);
  }
}

TEST(Kernel, SumsWhatSupportsAndChargesTheBackground) {
  const std::vector<double> squared = squared_distances();
  const KernelOptions options{kThreshold, 2.0, 0.25, 3.0};
  double score = 0.0;
  int inliers = 0;
  for (const double s : squared) {
    const double distance = std::sqrt(s) / kThreshold;
    if (distance < 2.0) score += std::exp(-0.5 * distance * distance);
    if (distance < 1.0) {
      ++inliers;
    } else if (distance < 3.0) {
      score -= 0.25;
    }
  }
  const KernelSum sum = sum_kernels(squared.data(), static_cast<int>(squared.size()), options);
  EXPECT_EQ(sum.inliers, inliers);
  EXPECT_NEAR(sum.score, score, 1e-3);
}

TEST(Kernel, TakesWhatCanBeNoInlierForNothing) {
  const std::vector<double> squared = {HUGE_VAL, std::numeric_limits<double>::quiet_NaN(), 0.0};
  std::vector<double> k(squared.size());
  kernels(squared.data(), 3, {}, k.data());
  EXPECT_EQ(k, (std::vector<double>{0.0, 0.0, 1.0}));
  const KernelSum sum = sum_kernels(squared.data(), 3, {.background_cost = 1.0});
  EXPECT_EQ(sum.score, 1.0);
  EXPECT_EQ(sum.inliers, 1);
}

}  // namespace
}  // namespace planecast::slam
