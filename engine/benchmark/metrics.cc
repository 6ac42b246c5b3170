#include "engine/benchmark/metrics.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/evaluate/statistics.h"

namespace planecast::engine {

const std::vector<MetricInfo>& metric_infos() {
  static const std::vector<MetricInfo> infos = {
      {"frames", "frames", 0, true},
      {"ate_cm", "ATE cm", 2, false},
      {"ate_keyframes_cm", "ATE keyframes cm", 2, false},
      {"ate_causal_cm", "ATE causal cm", 2, false},
      {"ate_percent", "ATE / path %", 3, false},
      {"path_m", "path m", 2, true},
      {"scale", "scale", 4, true},
      {"rpe_cm", "RPE cm/s", 2, false},
      {"rpe_deg", "RPE deg/s", 2, false},
      {"posed_percent", "posed %", 1, true},
      {"posed_causal_percent", "posed causal %", 1, true},
      {"first_posed", "first posed frame", 0, false},
      {"lost", "lost frames", 0, false},
      {"keyframes", "keyframes", 0, true},
      {"points", "points", 0, true},
      {"planes", "planes", 0, true},
      {"true_planes", "true planes", 0, true},
      {"precision_5", "precision 5 cm", 2, true},
      {"recall_5", "recall 5 cm", 2, true},
      {"f_5", "F 5 cm/10 deg", 2, true},
      {"precision_2", "precision 2 cm", 2, true},
      {"recall_2", "recall 2 cm", 2, true},
      {"f_2", "F 2 cm/5 deg", 2, true},
      {"supported_planes", "true planes with 24 points", 0, true},
      {"supported_found", "found", 0, true},
      {"f_supported", "F of these", 3, true},
      {"false_planes", "false", 0, false},
      {"over_segmented", "over-seg.", 0, false},
      {"under_segmented", "under-seg.", 0, false},
      {"normal_deg", "normal deg", 2, false},
      {"normal_p90_deg", "normal p90 deg", 2, false},
      {"offset_cm", "offset cm", 2, false},
      {"offset_p90_cm", "offset p90 cm", 2, false},
      {"point_rms_cm", "points to true plane cm", 2, false},
      {"plane_rms_before_cm", "point-plane RMS before cm", 3, false},
      {"plane_rms_after_cm", "after cm", 3, false},
      {"rand_index", "RI", 3, true},
      {"voi_nats", "VOI nats", 3, false},
      {"segmentation_covering", "SC", 3, true},
      {"drift_px", "drift px", 2, false},
      {"drift_p95_px", "drift p95 px", 2, false},
      {"drift_aligned_px", "aligned drift px", 2, false},
      {"jitter_px", "jitter px", 3, false},
      {"drift_causal_px", "causal drift px", 2, false},
      {"jitter_causal_px", "causal jitter px", 3, false},
      {"seconds", "time s", 1, false},
      {"cpu_seconds", "CPU s", 1, false},
      {"ms_per_frame", "ms a frame", 1, false},
      {"peak_mb", "peak MB", 0, false},
  };
  return infos;
}

MetricInfo metric_info(const std::string& key) {
  for (const MetricInfo& info : metric_infos()) {
    if (info.key == key) return info;
  }
  return {key, key, 2, false};
}

MetricSummary summarise_metric(const std::vector<const Metrics*>& runs, const MetricInfo& info) {
  std::vector<double> values;
  for (const Metrics* run : runs) {
    if (const auto found = run->find(info.key); found != run->end())
      values.push_back(found->second);
  }
  MetricSummary summary;
  if (values.empty()) return summary;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  summary.worst = info.more_is_better ? *least : *most;
  const Statistics statistics = statistics_of(values);
  summary.count = statistics.count;
  summary.median = statistics.median;
  summary.mean = statistics.mean;
  return summary;
}

std::string format_summary(const MetricSummary& summary, int decimals) {
  if (summary.count == 0) return "-";
  if (summary.count == 1) return fmt::format("{:.{}f}", summary.median, decimals);
  const std::string median = fmt::format("{:.{}f}", summary.median, decimals);
  const std::string mean = fmt::format("{:.{}f}", summary.mean, decimals);
  const std::string worst = fmt::format("{:.{}f}", summary.worst, decimals);
  if (mean == median && worst == median) return median;
  return fmt::format("{} ({}, {})", median, mean, worst);
}

}  // namespace planecast::engine
