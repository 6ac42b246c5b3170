#include "engine/evaluate/statistics.h"

#include <algorithm>
#include <cmath>

namespace planecast::engine {

double percentile_of_sorted(const std::vector<double>& ascending, double q) {
  if (ascending.empty()) return 0.0;
  const double rank = q * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  const double weight = rank - static_cast<double>(below);
  return (1.0 - weight) * ascending[below] + weight * ascending[above];
}

Statistics statistics_of(std::vector<double> values) {
  Statistics result;
  if (values.empty()) return result;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  result.count = static_cast<int>(values.size());
  result.rms = std::sqrt(sum_of_squares / count);
  result.mean = sum / count;
  result.median = percentile_of_sorted(values, 0.5);
  result.p90 = percentile_of_sorted(values, 0.9);
  result.p95 = percentile_of_sorted(values, 0.95);
  result.max = values.back();
  return result;
}

}  // namespace planecast::engine
