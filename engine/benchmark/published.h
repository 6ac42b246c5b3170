#pragma once

#include <string>
#include <vector>

#include "engine/benchmark/config.h"
#include "engine/benchmark/result_groups.h"

namespace planecast::engine {

/// Columns of others that say something about the sequences of these groups.
std::vector<const PublishedColumn*> published_columns(
    const BenchmarkConfig& config, const std::string& metric, const std::string& mode,
    const std::vector<const ResultGroup*>& groups);

/// A figure as it was printed, "-" where there is none.
std::string published_figure(const PublishedColumn& column, const std::string& mode,
                             const std::string& row);

/// Says that these columns are not measured here, and where they are from. Empty without columns.
std::string published_note(const std::vector<const PublishedColumn*>& columns);

}  // namespace planecast::engine
