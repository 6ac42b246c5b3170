#pragma once

#include <string>
#include <vector>

#include "engine/benchmark/config.h"
#include "engine/benchmark/result_groups.h"

namespace planecast::engine {

/// Milliseconds of each step over all runs, a pair of columns (mean of the runs' means, median of
/// their medians) for each mode, beside what others printed. Empty where nothing was timed.
std::string timing_table(const BenchmarkConfig& config, const std::vector<ResultGroup>& groups);

/// Each variant against the first one on the sequences where both have the figure. Empty where
/// there is one variant alone.
std::string ablation_table(const BenchmarkConfig& config, const std::vector<ResultGroup>& groups,
                           const std::string& mode);

}  // namespace planecast::engine
