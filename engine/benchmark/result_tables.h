#pragma once

#include <string>
#include <vector>

#include "engine/benchmark/config.h"
#include "engine/benchmark/result_groups.h"

namespace planecast::engine {

/// One of benchmark_table_names() as Markdown with its heading; empty where nothing was measured
/// for it. A cell is the median over the seeds, followed by mean and worst in brackets where there
/// are several.
std::string benchmark_table(const std::string& name, const BenchmarkConfig& config,
                            const std::vector<ResultGroup>& groups);

/// results.csv: one line a run, every metric a column, the mean times of the stages last.
std::string benchmark_csv(const std::vector<BenchmarkRow>& rows);

}  // namespace planecast::engine
