#pragma once

#include <map>
#include <string>
#include <vector>

namespace planecast::engine {

/// Figures of one run by key. What does not apply (no truth, no planes) is absent.
using Metrics = std::map<std::string, double>;

/// Keys of the times of a stage begin with these.
inline constexpr const char* kMeanTimePrefix = "mean_ms:";
inline constexpr const char* kMedianTimePrefix = "median_ms:";

struct MetricInfo {
  std::string key;
  std::string label;  ///< with the unit
  int decimals = 2;
  bool more_is_better = false;
};

/// Every metric of a run in the order of the CSV file, without the times of the stages.
const std::vector<MetricInfo>& metric_infos();
/// By key; times of stages ("mean_ms:STAGE", "median_ms:STAGE") are known too. A key that is not
/// known describes itself.
MetricInfo metric_info(const std::string& key);

/// Of one metric over the seeds.
struct MetricSummary {
  int count = 0;
  double median = 0.0;
  double mean = 0.0;
  double worst = 0.0;
};
MetricSummary summarise_metric(const std::vector<const Metrics*>& runs, const MetricInfo& info);

/// "median (mean, worst)", "median" alone where the three do not differ as printed, "-" where there
/// is none.
std::string format_summary(const MetricSummary& summary, int decimals);

}  // namespace planecast::engine
