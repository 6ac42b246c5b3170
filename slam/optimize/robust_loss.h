#pragma once

#include <vector>

namespace planecast::slam {

enum class RobustLoss {
  kSquared,
  kHuber,   ///< at the thresholds of chi2
  kCauchy,  ///< at the spread, so that the few sights that are wrong have little say; not convex
};

/// Loss of a residual's square. `width2` is where it bends: Huber's threshold, the square of Cauchy's
/// width.
double robust_cost(RobustLoss loss, double chi2, double width2);
/// Its slope, which is what the residual weighs: 1 for small ones.
double robust_weight(RobustLoss loss, double chi2, double width2);

/// What the residuals of most sights really vary by (chi2), as a share of what their sigmas say: a
/// keypoint's sigma is that of a corner, while most sights are aligned to a fraction of it.
struct ResidualSpread {
  double mono = 1.0;   ///< of sights without depth
  double depth = 1.0;  ///< of those with it
  /// Over the mean curvature that Cauchy leaves to a sight: what else is in a problem keeps its
  /// say.
  double gain = 1.0;
};

/// From the median of squared residuals, by that of as many normal errors of their sigma (2 rows:
/// two coordinates; 3: depth as well); between 1e-4 and 1, and 1 where there are none. Reorders
/// `chi2`.
double spread_of(std::vector<double>& chi2, int rows);

}  // namespace planecast::slam
