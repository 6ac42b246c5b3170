#include "engine/benchmark/result_groups.h"

#include <fmt/format.h>

#include <algorithm>

namespace planecast::engine {

std::vector<const Metrics*> ResultGroup::metrics() const {
  std::vector<const Metrics*> result;
  for (const BenchmarkRow* row : rows) {
    if (row->usable()) result.push_back(&row->metrics);
  }
  return result;
}

MetricSummary ResultGroup::summary(const std::string& metric) const {
  return summarise_metric(metrics(), metric_info(metric));
}

bool ResultGroup::is_present() const {
  return std::any_of(rows.begin(), rows.end(),
                     [](const BenchmarkRow* row) { return row->status != "not present"; });
}

std::string ResultGroup::status() const {
  if (!is_present()) return "not present";
  std::string first_failure;
  int failed = 0;
  int poor = 0;
  for (const BenchmarkRow* row : rows) {
    if (row->status == "poor") ++poor;
    if (row->usable()) continue;
    ++failed;
    if (first_failure.empty()) first_failure = row->status;
  }
  const std::size_t count = rows.size();
  if (failed > 0 && count == 1) return first_failure;
  if (failed > 0) return fmt::format("{} of {} {}", failed, count, first_failure);
  if (poor > 0 && count == 1) return "poor";
  if (poor > 0) return fmt::format("{} of {} poor", poor, count);
  return "ok";
}

std::vector<ResultGroup> group_rows(const std::vector<BenchmarkRow>& rows) {
  std::vector<ResultGroup> groups;
  for (const BenchmarkRow& row : rows) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&row](const ResultGroup& group) {
      return group.sequence == row.run.sequence && group.variant == row.run.variant &&
             group.mode == row.run.mode;
    });
    if (same != groups.end()) {
      same->rows.push_back(&row);
    } else {
      groups.push_back({row.run.sequence, row.run.variant, row.run.mode, {&row}});
    }
  }
  return groups;
}

std::vector<std::string> modes_of(const std::vector<ResultGroup>& groups) {
  std::vector<std::string> modes;
  for (const ResultGroup& group : groups) {
    if (std::find(modes.begin(), modes.end(), group.mode) == modes.end()) {
      modes.push_back(group.mode);
    }
  }
  return modes;
}

std::vector<const ResultGroup*> groups_of_mode(const std::vector<ResultGroup>& groups,
                                               const std::string& mode) {
  std::vector<const ResultGroup*> result;
  for (const ResultGroup& group : groups) {
    if (group.mode == mode) result.push_back(&group);
  }
  return result;
}

}  // namespace planecast::engine
