#pragma once

#include <cmath>
#include <vector>

namespace planecast::slam {

enum class RobustLoss {
  kSquared,
  kHuber,   ///< at the thresholds of chi2
  kCauchy,  ///< at the spread, so that the few sights that are wrong have little say; not convex
};

/// Loss of a residual's square. `width2` is where it bends: Huber's threshold, the square of
/// Cauchy's width.
inline double robust_cost(RobustLoss loss, double chi2, double width2) {
  if (loss == RobustLoss::kCauchy) return width2 * std::log1p(chi2 / width2);
  if (loss == RobustLoss::kSquared || chi2 <= width2) return chi2;
  return 2.0 * std::sqrt(chi2 * width2) - width2;
}

/// Its slope, which is what the residual weighs: 1 for small ones.
inline double robust_weight(RobustLoss loss, double chi2, double width2) {
  if (loss == RobustLoss::kCauchy) return width2 / (width2 + chi2);
  if (loss == RobustLoss::kSquared || chi2 <= width2) return 1.0;
  return std::sqrt(width2 / chi2);
}

/// What the residuals of most sights really vary by (chi2), as a share of what their sigmas say: a
/// keypoint's sigma is that of a corner, while most sights are aligned to a fraction of it.
struct ResidualSpread {
  double mono = 1.0;   ///< of sights without depth
  double depth = 1.0;  ///< of those with it
  /// Over the mean curvature that Cauchy leaves to a sight: what else is in a problem keeps its
  /// say.
  double gain = 1.0;
};

/// Where a loss bends for a sight whose chi2 is tested at `threshold` (95 %): there, or for Cauchy
/// at the spread's share of it, which is 2.4 standard deviations, at which it is worth 95 % of
/// least squares on normal errors.
inline double bend_of(RobustLoss loss, const ResidualSpread& spread, double threshold, bool depth) {
  if (loss != RobustLoss::kCauchy) return threshold;
  return threshold * (depth ? spread.depth : spread.mono);
}

/// From the median of squared residuals, by that of as many normal errors of their sigma (2 rows:
/// two coordinates; 3: depth as well); between 1e-4 and 1, and 1 where there are none. Reorders
/// `chi2`.
double spread_of(std::vector<double>& chi2, int rows);

}  // namespace planecast::slam
