#pragma once

namespace planecast::slam {

/// How points count for a model in Graph-Cut RANSAC.
struct KernelOptions {
  double threshold = 1.0;  ///< eps_d, in the unit of the residuals
  /// [D] Distance, in thresholds, beyond which a point supports nothing: K falls below 0.14 there.
  double reach = 2.0;
  /// Charged for each point between 1 and `background_reach` thresholds.
  double background_cost = 0.0;
  double background_reach = 3.0;
};

struct KernelSum {
  double score = 0.0;  ///< sum of the kernels less what the background costs
  int inliers = 0;     ///< points within the threshold
};

/// K = exp(-r^2 / (2 threshold^2)) of n squared residuals, within 3e-6; 0 beyond the reach and for
/// what is not a number.
void kernels(const double* squared, int n, const KernelOptions& options, double* kernel);

/// Sums over n squared residuals.
KernelSum sum_kernels(const double* squared, int n, const KernelOptions& options);

}  // namespace planecast::slam
