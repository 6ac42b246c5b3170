#include "slam/optimize/robust_loss.h"

#include <gtest/gtest.h>

#include "slam/geometry/random.h"
#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

TEST(RobustLoss, WeightIsTheSlopeOfTheCost) {
  constexpr double kStep = 1e-6;
  for (const RobustLoss loss : {RobustLoss::kSquared, RobustLoss::kHuber, RobustLoss::kCauchy}) {
    for (const double chi2 : {0.01, 0.5, 2.9, 3.1, 20.0, 1000.0}) {
      const double slope =
          (robust_cost(loss, chi2 + kStep, 3.0) - robust_cost(loss, chi2 - kStep, 3.0)) /
          (2.0 * kStep);
      EXPECT_NEAR(robust_weight(loss, chi2, 3.0), slope, 1e-6) << chi2;
    }
    EXPECT_EQ(robust_cost(loss, 0.0, 3.0), 0.0);
    EXPECT_EQ(robust_weight(loss, 0.0, 3.0), 1.0);
  }
}

TEST(RobustLoss, SpreadIsThatOfMostResiduals) {
  Random random(seed_of("RobustLoss.SpreadIsThatOfMostResiduals"));
  constexpr double kSigma = 0.2;
  for (const int rows : {2, 3}) {
    std::vector<double> chi2;
    for (int i = 0; i < 4000; ++i) {
      double sum = 0.0;
      for (int k = 0; k < rows; ++k) sum += std::pow(kSigma * gaussian(random), 2);
      chi2.push_back(i % 20 == 0 ? 4.0 : sum);
    }
    // The median of 4000 is known to 3 %; one of twenty being wrong raises it by 7 %.
    EXPECT_NEAR(spread_of(chi2, rows) / (kSigma * kSigma), 1.07, 0.1);
  }
  std::vector<double> none, exact(10, 0.0), wide(10, 50.0);
  EXPECT_EQ(spread_of(none, 2), 1.0);
  EXPECT_EQ(spread_of(exact, 2), 1e-4);
  EXPECT_EQ(spread_of(wide, 3), 1.0);
}

}  // namespace
}  // namespace planecast::slam
