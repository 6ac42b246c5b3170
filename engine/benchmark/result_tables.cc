#include "engine/benchmark/result_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/output/csv.h"
#include "engine/output/tables.h"

namespace planecast::engine {
namespace {

constexpr const char* kMeanPrefix = "mean_ms:";
constexpr const char* kMedianPrefix = "median_ms:";

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
        "offset_p90_cm", "point_rms_cm", "plane_rms_before", "plane_rms_after", "rand_index",
        "voi_nats", "segmentation_covering"}},
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

/// A Markdown table that is filled cell by cell; the first `left` columns are text.
class MarkdownTable {
 public:
  MarkdownTable(std::vector<std::string> header, std::size_t left) {
    std::string line = "|";
    for (std::size_t i = 0; i < header.size(); ++i) line += i < left ? " :-- |" : " --: |";
    text_ = row_of(header) + line + "\n";
  }
  void row(const std::vector<std::string>& cells) { text_ += row_of(cells); }
  const std::string& str() const { return text_; }

 private:
  static std::string row_of(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (std::string cell : cells) {
      for (std::size_t at = 0; (at = cell.find('|', at)) != std::string::npos; at += 2) {
        cell.replace(at, 1, "\\|");
      }
      line += " " + cell + " |";
    }
    return line + "\n";
  }
  std::string text_;
};

bool any_has(const std::vector<const ResultGroup*>& groups, const std::string& metric) {
  return std::any_of(groups.begin(), groups.end(), [&metric](const ResultGroup* group) {
    return group->summary(metric).count > 0;
  });
}

std::vector<const ResultGroup*> of_mode(const std::vector<ResultGroup>& groups,
                                        const std::string& mode) {
  std::vector<const ResultGroup*> result;
  for (const ResultGroup& group : groups) {
    if (group.mode == mode) result.push_back(&group);
  }
  return result;
}

/// Columns of others that say something about these sequences.
std::vector<const PublishedColumn*> columns_for(const BenchmarkConfig& config,
                                                const std::string& metric, const std::string& mode,
                                                const std::vector<const ResultGroup*>& groups) {
  std::vector<const PublishedColumn*> columns;
  for (const PublishedColumn& column : config.published) {
    const auto figures = column.figures.find(mode);
    if (column.metric != metric || figures == column.figures.end()) continue;
    const bool speaks = std::any_of(groups.begin(), groups.end(), [&](const ResultGroup* group) {
      return figures->second.count(group->sequence->name) > 0;
    });
    if (speaks) columns.push_back(&column);
  }
  return columns;
}

std::string published_note(const std::vector<const PublishedColumn*>& columns) {
  if (columns.empty()) return "";
  std::string note =
      "\nColumns with a name in *italics* are not measured here; they are as printed:\n\n";
  for (const PublishedColumn* column : columns) {
    note += fmt::format("- *{}*: {}\n", column->name, column->source);
  }
  return note;
}

std::string figure_of(const PublishedColumn& column, const std::string& mode,
                      const std::string& row) {
  const auto figures = column.figures.find(mode);
  if (figures == column.figures.end()) return "-";
  const auto figure = figures->second.find(row);
  return figure == figures->second.end() ? "-" : figure->second;
}

std::string metric_table(const TableKind& kind, const BenchmarkConfig& config,
                         const std::vector<ResultGroup>& all, const std::string& mode) {
  std::vector<const ResultGroup*> groups = of_mode(all, mode);
  std::vector<std::string> metrics;
  for (const std::string& metric : kind.metrics) {
    if (any_has(groups, metric)) metrics.push_back(metric);
  }
  const auto published = columns_for(config, kind.metrics.front(), mode, groups);
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
      cells.push_back(figure_of(*column, mode, group->sequence->name));
    }
    cells.push_back(group->status());
    table.row(cells);
  }
  return table.str() + published_note(published);
}

/// Names of the stages that were timed, in their order in the paper's Table 2, then the others.
std::vector<std::string> stage_names(const std::vector<ResultGroup>& groups,
                                     const std::vector<const PublishedColumn*>& published) {
  std::vector<std::string> names = paper_timing_names();
  std::set<std::string> measured;
  for (const ResultGroup& group : groups) {
    for (const Metrics* run : group.metrics()) {
      for (const auto& [key, value] : *run) {
        if (key.starts_with(kMeanPrefix))
          measured.insert(key.substr(std::string(kMeanPrefix).size()));
      }
    }
  }
  for (const PublishedColumn* column : published) {
    for (const auto& [stage, value] : column->figures.at("any")) measured.insert(stage);
  }
  for (const std::string& stage : measured) {
    if (std::find(names.begin(), names.end(), stage) == names.end()) names.push_back(stage);
  }
  std::erase_if(names, [&measured](const std::string& name) { return measured.count(name) == 0; });
  return names;
}

/// Means of the runs' means and medians of their medians, a pair of columns for each mode.
std::string timing_table(const BenchmarkConfig& config, const std::vector<ResultGroup>& groups) {
  std::vector<const PublishedColumn*> published;
  for (const PublishedColumn& column : config.published) {
    if (column.metric == "mean_ms") published.push_back(&column);
  }
  const std::vector<std::string> modes = modes_of(groups);
  const std::vector<std::string> stages = stage_names(groups, published);
  if (stages.empty()) return "";
  std::vector<std::string> header = {"ms"};
  for (const std::string& mode : modes) {
    header.insert(header.end(), {mode + " mean", mode + " median"});
  }
  for (const PublishedColumn* column : published) header.push_back("*" + column->name + "*");
  MarkdownTable table(header, 1);
  for (const std::string& stage : stages) {
    std::vector<std::string> cells = {stage};
    for (const std::string& mode : modes) {
      std::vector<const Metrics*> runs;
      for (const ResultGroup* group : of_mode(groups, mode)) {
        const auto of_group = group->metrics();
        runs.insert(runs.end(), of_group.begin(), of_group.end());
      }
      const MetricSummary mean = summarise_metric(runs, metric_info(kMeanPrefix + stage));
      const MetricSummary median = summarise_metric(runs, metric_info(kMedianPrefix + stage));
      cells.push_back(mean.count > 0 ? fmt::format("{:.2f}", mean.mean) : "-");
      cells.push_back(median.count > 0 ? fmt::format("{:.2f}", median.median) : "-");
    }
    for (const PublishedColumn* column : published) {
      cells.push_back(figure_of(*column, "any", stage));
    }
    table.row(cells);
  }
  return table.str() + published_note(published);
}

/// How a variant compares with the first one on the sequences where both have the figure.
struct Comparison {
  int sequences = 0;
  int better = 0;           ///< strictly
  double ratio = 1.0;       ///< geometric mean of the medians' ratios
  double mean_first = 0.0;  ///< of the first variant's medians
  double mean = 0.0;
};

Comparison compare(const std::vector<const ResultGroup*>& groups, const BenchmarkVariant* variant,
                   const BenchmarkVariant* first, const MetricInfo& metric) {
  Comparison result;
  double sum_of_logs = 0.0;
  for (const ResultGroup* base : groups) {
    if (base->variant != first) continue;
    for (const ResultGroup* other : groups) {
      if (other->variant != variant || other->sequence != base->sequence) continue;
      const MetricSummary a = base->summary(metric.key);
      const MetricSummary b = other->summary(metric.key);
      if (a.count == 0 || b.count == 0) continue;
      ++result.sequences;
      result.mean_first += a.median;
      result.mean += b.median;
      if (metric.more_is_better ? b.median > a.median : b.median < a.median) ++result.better;
      sum_of_logs += std::log(std::max(b.median, 1e-9) / std::max(a.median, 1e-9));
    }
  }
  if (result.sequences == 0) return result;
  result.mean_first /= result.sequences;
  result.mean /= result.sequences;
  result.ratio = std::exp(sum_of_logs / result.sequences);
  return result;
}

std::string ablation_table(const BenchmarkConfig& config, const std::vector<ResultGroup>& all,
                           const std::string& mode) {
  if (config.variants.size() < 2) return "";
  const std::vector<const ResultGroup*> groups = of_mode(all, mode);
  const BenchmarkVariant* first = &config.variants.front();
  MarkdownTable table({"variant", "sequences", "ATE ratio", "ATE better on", "F 5 cm (first)",
                       "drift ratio", "time ratio"},
                      1);
  bool filled = false;
  for (const BenchmarkVariant& variant : config.variants) {
    const Comparison ate = compare(groups, &variant, first, metric_info("ate_cm"));
    const Comparison f = compare(groups, &variant, first, metric_info("f_5"));
    const Comparison drift = compare(groups, &variant, first, metric_info("drift_px"));
    const Comparison time = compare(groups, &variant, first, metric_info("ms_per_frame"));
    if (time.sequences == 0) continue;
    filled = true;
    const auto ratio = [](const Comparison& c) {
      return c.sequences > 0 ? fmt::format("{:.3f}", c.ratio) : std::string("-");
    };
    table.row({variant.name, std::to_string(time.sequences), ratio(ate),
               &variant == first ? "-" : fmt::format("{} of {}", ate.better, ate.sequences),
               f.sequences > 0 ? fmt::format("{:.2f} ({:.2f})", f.mean, f.mean_first) : "-",
               ratio(drift), ratio(time)});
  }
  if (!filled) return "";
  return table.str() + fmt::format(
                           "\nRatios to *{}*: geometric mean over the sequences where both "
                           "have the figure; below 1 is better.\n",
                           first->name);
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
    std::string heading = "Variants against the first";
    std::string table;
    if (name == "ablation") {
      table = ablation_table(config, groups, mode);
    } else {
      for (const TableKind& kind : table_kinds()) {
        if (kind.name != name) continue;
        heading = kind.heading;
        table = metric_table(kind, config, groups, mode);
      }
    }
    if (!table.empty()) text += fmt::format("## {}: {}\n\n{}\n", heading, mode, table);
  }
  return text;
}

std::string benchmark_csv(const std::vector<BenchmarkRow>& rows) {
  std::set<std::string> stages;
  for (const BenchmarkRow& row : rows) {
    for (const auto& [key, value] : row.metrics) {
      if (key.starts_with(kMeanPrefix)) stages.insert(key);
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
