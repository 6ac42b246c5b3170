#include "engine/benchmark/result_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/benchmark/comparison_tables.h"
#include "engine/benchmark/markdown_table.h"
#include "engine/benchmark/published.h"
#include "engine/output/csv.h"

namespace planecast::engine {
namespace {

struct TableKind {
  const char* name;
  const char* heading;
  std::vector<std::string> metrics;
};

const std::vector<TableKind>& table_kinds() {
  static const std::vector<TableKind> kinds = {
      {"ate",
       "Trajectory",
       {"ate_cm", "ate_percent", "ate_keyframes_cm", "ate_causal_cm", "rpe_cm", "rpe_deg"}},
      {"tracking",
       "Tracking",
       {"frames", "posed_causal_percent", "posed_percent", "first_posed", "lost", "keyframes"}},
      {"planes",
       "Planes",
       {"planes", "true_planes", "precision_5", "recall_5", "f_5", "f_2", "false_planes",
        "over_segmented", "under_segmented", "normal_deg", "normal_p90_deg", "offset_cm",
        "offset_p90_cm"}},
      {"planes",
       "Points on planes",
       {"point_rms_cm", "plane_rms_before_cm", "plane_rms_after_cm", "rand_index", "voi_nats",
        "segmentation_covering"}},
      {"supported",
       "Planes that the map can know",
       {"f_supported", "supported_planes", "supported_found", "planes", "false_planes",
        "over_segmented", "normal_deg", "offset_cm", "ate_cm", "plane_rms_before_cm",
        "plane_rms_after_cm"}},
      {"overlay",
       "Overlay",
       {"drift_px", "drift_p95_px", "jitter_px", "drift_causal_px", "jitter_causal_px",
        "drift_aligned_px"}},
      {"resources",
       "Time and memory",
       {"frames", "keyframes", "points", "seconds", "cpu_seconds", "ms_per_frame", "peak_mb"}},
  };
  return kinds;
}

bool any_has(const std::vector<const ResultGroup*>& groups, const std::string& metric) {
  return std::any_of(groups.begin(), groups.end(), [&metric](const ResultGroup* group) {
    return group->summary(metric).count > 0;
  });
}

std::string metric_table(const TableKind& kind, const BenchmarkConfig& config,
                         const std::vector<ResultGroup>& all, const std::string& mode) {
  std::vector<const ResultGroup*> groups = groups_of_mode(all, mode);
  std::vector<std::string> metrics;
  for (const std::string& metric : kind.metrics) {
    if (any_has(groups, metric)) metrics.push_back(metric);
  }
  const auto published = published_columns(config, kind.metrics.front(), mode, groups);
  if (metrics.empty() && published.empty()) return "";
  if (metrics.empty()) metrics = {kind.metrics.front()};
  const bool variants = config.variants.size() > 1;
  std::vector<std::string> header = {"sequence"};
  if (variants) header.emplace_back("variant");
  for (const std::string& metric : metrics) header.push_back(metric_info(metric).label);
  for (const PublishedColumn* column : published) header.push_back("*" + column->name + "*");
  header.emplace_back("status");
  MarkdownTable table(header, variants ? 2 : 1);
  for (const ResultGroup* group : groups) {
    // What is absent stands in a table only for the figures of others.
    if (!group->is_present() && published.empty()) continue;
    std::vector<std::string> cells = {group->sequence->name};
    if (variants) cells.push_back(group->variant->name);
    for (const std::string& metric : metrics) {
      cells.push_back(format_summary(group->summary(metric), metric_info(metric).decimals));
    }
    for (const PublishedColumn* column : published) {
      cells.push_back(published_figure(*column, mode, group->sequence->name));
    }
    cells.push_back(group->status());
    table.row(cells);
  }
  return table.str() + published_note(published);
}

}  // namespace

std::string benchmark_table(const std::string& name, const BenchmarkConfig& config,
                            const std::vector<ResultGroup>& groups) {
  if (name == "timings") {
    const std::string table = timing_table(config, groups);
    return table.empty() ? "" : "## Time of each step\n\n" + table + "\n";
  }
  std::string text;
  for (const std::string& mode : modes_of(groups)) {
    const auto add = [&text, &mode](const char* heading, const std::string& table) {
      if (!table.empty()) text += fmt::format("## {}: {}\n\n{}\n", heading, mode, table);
    };
    if (name == "ablation") {
      add("Variants against the first", ablation_table(config, groups, mode));
      continue;
    }
    for (const TableKind& kind : table_kinds()) {
      if (kind.name == name) add(kind.heading, metric_table(kind, config, groups, mode));
    }
  }
  return text;
}

std::string benchmark_csv(const std::vector<BenchmarkRow>& rows) {
  std::set<std::string> stages;
  for (const BenchmarkRow& row : rows) {
    for (const auto& [key, value] : row.metrics) {
      if (key.starts_with(kMeanTimePrefix)) stages.insert(key);
    }
  }
  std::vector<std::string> keys;
  for (const MetricInfo& info : metric_infos()) keys.push_back(info.key);
  keys.insert(keys.end(), stages.begin(), stages.end());
  std::string text = "sequence,group,mode,variant,seed,status";
  for (const std::string& key : keys) text += "," + csv_field(key);
  text += "\n";
  for (const BenchmarkRow& row : rows) {
    text += fmt::format("{},{},{},{},{},{}", csv_field(row.run.sequence->name),
                        csv_field(row.run.sequence->group), row.run.mode,
                        csv_field(row.run.variant->name), row.run.seed, csv_field(row.status));
    for (const std::string& key : keys) {
      const auto found = row.metrics.find(key);
      text += found == row.metrics.end() ? "," : fmt::format(",{:.6g}", found->second);
    }
    text += "\n";
  }
  return text;
}

}  // namespace planecast::engine
