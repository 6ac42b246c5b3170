#pragma once

#include <vector>

namespace planecast::engine {

/// Statistics of a sample; all zero for an empty one.
struct Statistics {
  int count = 0;
  double rms = 0.0;
  double mean = 0.0;
  double median = 0.0;  ///< mean of the middle two for an even count
  double p90 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

Statistics statistics_of(std::vector<double> values);

/// Percentile of ascending values with linear interpolation between ranks, q in [0, 1].
double percentile_of_sorted(const std::vector<double>& ascending, double q);

}  // namespace planecast::engine
