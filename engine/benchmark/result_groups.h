#pragma once

#include <string>
#include <vector>

#include "engine/benchmark/runner.h"

namespace planecast::engine {

/// The runs that differ by their seed alone.
struct ResultGroup {
  const BenchmarkSequence* sequence = nullptr;
  const BenchmarkVariant* variant = nullptr;
  std::string mode;
  std::vector<const BenchmarkRow*> rows;

  std::vector<const Metrics*> metrics() const;  ///< of the usable runs
  MetricSummary summary(const std::string& metric) const;
  /// "ok", or what became of the runs that were not.
  std::string status() const;
  bool is_present() const;
};

/// In the order of the rows.
std::vector<ResultGroup> group_rows(const std::vector<BenchmarkRow>& rows);

/// The modes in order of first appearance.
std::vector<std::string> modes_of(const std::vector<ResultGroup>& groups);

std::vector<const ResultGroup*> groups_of_mode(const std::vector<ResultGroup>& groups,
                                               const std::string& mode);

}  // namespace planecast::engine
