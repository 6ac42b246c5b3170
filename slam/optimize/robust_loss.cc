#include "slam/optimize/robust_loss.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace planecast::slam {

double robust_cost(RobustLoss loss, double chi2, double width2) {
  if (loss == RobustLoss::kCauchy) return width2 * std::log1p(chi2 / width2);
  if (loss == RobustLoss::kSquared || chi2 <= width2) return chi2;
  return 2.0 * std::sqrt(chi2 * width2) - width2;
}

double robust_weight(RobustLoss loss, double chi2, double width2) {
  if (loss == RobustLoss::kCauchy) return width2 / (width2 + chi2);
  if (loss == RobustLoss::kSquared || chi2 <= width2) return 1.0;
  return std::sqrt(width2 / chi2);
}

double spread_of(std::vector<double>& chi2, int rows) {
  // Medians of chi2 with two and three degrees of freedom.
  constexpr double kMedian2 = 1.386;
  constexpr double kMedian3 = 2.366;
  constexpr double kLeast = 1e-4;
  if (chi2.empty()) return 1.0;
  const auto middle = chi2.begin() + static_cast<std::ptrdiff_t>(chi2.size() / 2);
  std::nth_element(chi2.begin(), middle, chi2.end());
  return std::clamp(*middle / (rows == 3 ? kMedian3 : kMedian2), kLeast, 1.0);
}

}  // namespace planecast::slam
