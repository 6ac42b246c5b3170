#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/benchmark/runner.h"

namespace planecast::engine {

/// Writes results.md, results.csv and plots/*.svg below `folder`. `facts` are lines about how it
/// was measured (version, processor, options). Throws UserError where a file cannot be written.
void write_benchmark_report(const BenchmarkConfig& config, const std::vector<BenchmarkRow>& rows,
                            BenchmarkRunner& runner, const std::vector<std::string>& facts,
                            const std::filesystem::path& folder);

/// Name of the processor and the number of its threads, as the system tells.
std::string processor_name();

}  // namespace planecast::engine
