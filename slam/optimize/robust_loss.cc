#include "slam/optimize/robust_loss.h"

#include <algorithm>
#include <cstddef>

namespace planecast::slam {

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
