#include "engine/benchmark/comparison_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/benchmark/markdown_table.h"
#include "engine/benchmark/published.h"
#include "engine/evaluate/statistics.h"
#include "engine/output/tables.h"

namespace planecast::engine {
namespace {

/// Names of the stages that were timed, in their order in the paper's Table 2, then the others.
std::vector<std::string> stage_names(const std::vector<ResultGroup>& groups,
                                     const std::vector<const PublishedColumn*>& published) {
  std::vector<std::string> names = paper_timing_names();
  std::set<std::string> measured;
  for (const ResultGroup& group : groups) {
    for (const Metrics* run : group.metrics()) {
      for (const auto& [key, value] : *run) {
        if (key.starts_with(kMeanTimePrefix))
          measured.insert(key.substr(std::string(kMeanTimePrefix).size()));
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

/// How a variant compares with the first one on the sequences where both have the figure.
struct Comparison {
  int sequences = 0;
  int better = 0;      ///< strictly
  double ratio = 1.0;  ///< geometric mean of the medians' ratios
  double median_ratio = 1.0;
  double mean_first = 0.0;  ///< of the first variant's medians
  double mean = 0.0;
};

Comparison compare(const std::vector<const ResultGroup*>& groups, const BenchmarkVariant* variant,
                   const BenchmarkVariant* first, const MetricInfo& metric) {
  Comparison result;
  std::vector<double> ratios;
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
      ratios.push_back(std::max(b.median, 1e-9) / std::max(a.median, 1e-9));
    }
  }
  if (result.sequences == 0) return result;
  result.mean_first /= result.sequences;
  result.mean /= result.sequences;
  double sum_of_logs = 0.0;
  for (const double ratio : ratios) sum_of_logs += std::log(ratio);
  result.ratio = std::exp(sum_of_logs / result.sequences);
  result.median_ratio = statistics_of(ratios).median;
  return result;
}

}  // namespace

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
      for (const ResultGroup* group : groups_of_mode(groups, mode)) {
        const auto of_group = group->metrics();
        runs.insert(runs.end(), of_group.begin(), of_group.end());
      }
      const MetricSummary mean = summarise_metric(runs, metric_info(kMeanTimePrefix + stage));
      const MetricSummary median = summarise_metric(runs, metric_info(kMedianTimePrefix + stage));
      cells.push_back(mean.count > 0 ? fmt::format("{:.2f}", mean.mean) : "-");
      cells.push_back(median.count > 0 ? fmt::format("{:.2f}", median.median) : "-");
    }
    for (const PublishedColumn* column : published) {
      cells.push_back(published_figure(*column, "any", stage));
    }
    table.row(cells);
  }
  return table.str() + published_note(published);
}

std::string ablation_table(const BenchmarkConfig& config, const std::vector<ResultGroup>& all,
                           const std::string& mode) {
  if (config.variants.size() < 2) return "";
  const std::vector<const ResultGroup*> groups = groups_of_mode(all, mode);
  const BenchmarkVariant* first = &config.variants.front();
  MarkdownTable table({"variant", "sequences", "ATE ratio", "median", "ATE better on",
                       "F 5 cm (first)", "drift ratio", "time ratio"},
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
               ate.sequences > 0 ? fmt::format("{:.3f}", ate.median_ratio) : "-",
               &variant == first ? "-" : fmt::format("{} of {}", ate.better, ate.sequences),
               f.sequences > 0 ? fmt::format("{:.2f} ({:.2f})", f.mean, f.mean_first) : "-",
               ratio(drift), ratio(time)});
  }
  if (!filled) return "";
  return table.str() + fmt::format(
                           "\nRatios to *{}*: geometric mean over the sequences where both "
                           "have the figure; below 1 is better. Drift is that of the planes which "
                           "each variant found.\n",
                           first->name);
}

}  // namespace planecast::engine
