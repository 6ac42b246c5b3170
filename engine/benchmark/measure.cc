#include "engine/benchmark/measure.h"

#include <nlohmann/json.hpp>

#include "engine/evaluate/overlay.h"
#include "engine/evaluate/planes.h"
#include "engine/evaluate/trajectory.h"
#include "engine/output/atomic_file.h"
#include "engine/output/summary.h"
#include "engine/pipeline/reconstruction_io.h"

namespace planecast::engine {
namespace {

constexpr double kCentimetres = 100.0;
constexpr double kPercent = 100.0;

std::vector<TimedPose> causal_poses(const Reconstruction& map) {
  std::vector<TimedPose> poses;
  for (const FrameRecord& frame : map.frames) {
    if (frame.causal_world_from_cam) {
      poses.push_back({frame.timestamp, *frame.causal_world_from_cam});
    }
  }
  return poses;
}

std::vector<TimedPose> keyframe_poses(const Reconstruction& map) {
  std::vector<TimedPose> poses;
  for (const KeyframeRecord& keyframe : map.keyframes) {
    poses.push_back({keyframe.timestamp, keyframe.world_from_cam});
  }
  return poses;
}

double path_length(const std::vector<TimedPose>& poses) {
  double length = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    length +=
        (poses[i].world_from_cam.translation() - poses[i - 1].world_from_cam.translation()).norm();
  }
  return length;
}

/// True poses at the times of the frames: motion capture is faster, and its noise would count.
std::vector<TimedPose> at_frame_times(const Reconstruction& map, const SequenceTruth& truth,
                                      double max_difference_s) {
  std::vector<TimedPose> frames;
  for (const FrameRecord& frame : map.frames) {
    frames.push_back({frame.timestamp, slam::Pose::Identity()});
  }
  std::vector<TimedPose> poses;
  for (const auto& [f, t] : associate(frames, truth.poses, max_difference_s)) {
    poses.push_back(truth.poses[static_cast<std::size_t>(t)]);
  }
  return poses;
}

void count(const Reconstruction& map, Metrics& metrics) {
  const Summary summary = summarise(map);
  metrics["frames"] = summary.frames;
  metrics["posed_percent"] = kPercent * summary.localised / std::max(1, summary.frames);
  metrics["posed_causal_percent"] = kPercent * summary.tracked / std::max(1, summary.frames);
  if (summary.first_tracked_frame >= 0) metrics["first_posed"] = summary.frames_until_initialised;
  metrics["lost"] = summary.lost;
  metrics["keyframes"] = summary.keyframes;
  metrics["points"] = summary.points;
  metrics["planes"] = summary.planes;
}

void measure_trajectories(const Reconstruction& map, const SequenceTruth& truth,
                          const TrajectoryOptions& options, Metrics& metrics) {
  const double path_m = path_length(at_frame_times(map, truth, options.max_difference_s));
  metrics["path_m"] = path_m;
  if (const auto result = evaluate_trajectory(final_poses(map), truth.poses, options)) {
    metrics["ate_cm"] = kCentimetres * result->ate.rms;
    if (path_m > 0.0) metrics["ate_percent"] = kPercent * result->ate.rms / path_m;
    metrics["scale"] = result->truth_from_estimate.scale;
    if (result->rpe_translation.count > 0) {
      metrics["rpe_cm"] = kCentimetres * result->rpe_translation.rms;
      metrics["rpe_deg"] = result->rpe_rotation_deg.rms;
    }
  }
  if (const auto result = evaluate_trajectory(keyframe_poses(map), truth.poses, options)) {
    metrics["ate_keyframes_cm"] = kCentimetres * result->ate.rms;
  }
  if (const auto result = evaluate_trajectory(causal_poses(map), truth.poses, options)) {
    metrics["ate_causal_cm"] = kCentimetres * result->ate.rms;
  }
}

void measure_planes(const Reconstruction& map, const SequenceTruth& truth,
                    const PlaneEvaluationOptions& options, Metrics& metrics) {
  const auto result = evaluate_planes(map, truth.planes, truth.poses, truth.camera, options);
  if (!result) return;
  const PlaneScore& wide = result->scores[0];
  const PlaneScore& tight = result->scores[1];
  metrics["true_planes"] = wide.truth;
  metrics["precision_5"] = wide.precision;
  metrics["recall_5"] = wide.recall;
  metrics["f_5"] = wide.f;
  metrics["precision_2"] = tight.precision;
  metrics["recall_2"] = tight.recall;
  metrics["f_2"] = tight.f;
  metrics["supported_planes"] = result->supported.truth;
  metrics["supported_found"] = result->supported.found;
  if (result->supported.truth > 0) metrics["f_supported"] = result->supported.f;
  metrics["over_segmented"] = wide.over_segmented;
  metrics["under_segmented"] = wide.under_segmented;
  metrics["false_planes"] = wide.estimated - wide.matched - wide.over_segmented;
  metrics["rand_index"] = result->labels.rand_index;
  metrics["voi_nats"] = result->labels.variation_of_information;
  metrics["segmentation_covering"] = result->labels.segmentation_covering;
  if (wide.matched == 0) return;
  metrics["normal_deg"] = result->angle_deg.median;
  metrics["normal_p90_deg"] = result->angle_deg.p90;
  metrics["offset_cm"] = kCentimetres * result->offset_m.median;
  metrics["offset_p90_cm"] = kCentimetres * result->offset_m.p90;
  metrics["point_rms_cm"] = kCentimetres * result->point_rms_m.rms;
}

void measure_overlay(const Reconstruction& map, const SequenceTruth& truth, OverlayOptions options,
                     Metrics& metrics) {
  const auto final = evaluate_overlay(map, truth.planes, truth.poses, truth.camera, options);
  options.causal = true;
  const auto causal = evaluate_overlay(map, truth.planes, truth.poses, truth.camera, options);
  if (final && final->tapped.drift_px.count > 0) {
    metrics["drift_px"] = final->tapped.drift_px.rms;
    metrics["drift_p95_px"] = final->tapped.drift_px.p95;
    metrics["drift_aligned_px"] = final->aligned.drift_px.rms;
    metrics["jitter_px"] = final->tapped.jitter_px.rms;
  }
  if (causal && causal->tapped.drift_px.count > 0) {
    metrics["drift_causal_px"] = causal->tapped.drift_px.rms;
    metrics["jitter_causal_px"] = causal->tapped.jitter_px.rms;
  }
}

nlohmann::json read_json(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return {};
  return nlohmann::json::parse(read_file(file), nullptr, false);
}

void add_stage_times(const std::filesystem::path& folder, Metrics& metrics) {
  const nlohmann::json timings = read_json(folder / "timings.json");
  if (!timings.is_object() || !timings.contains("rows")) return;
  for (const nlohmann::json& row : timings["rows"]) {
    if (row.value("count", 0) == 0) continue;
    const std::string name = row.value("name", "");
    metrics[kMeanTimePrefix + name] = row.value("mean", 0.0);
    metrics[kMedianTimePrefix + name] = row.value("median", 0.0);
  }
}

/// Distances of the points to their planes before and after the joint refinement, where it was
/// recorded; in centimetres by the scale that the alignment found.
void add_plane_rms(const std::filesystem::path& folder, Metrics& metrics) {
  if (metrics.count("scale") == 0) return;
  const nlohmann::json summary = read_json(folder / "summary.json");
  if (!summary.is_object() || !summary.contains("point_plane_rms")) return;
  const nlohmann::json& rms = summary["point_plane_rms"];
  if (!rms.is_object()) return;
  const double unit_cm = kCentimetres * metrics["scale"];
  metrics["plane_rms_before_cm"] = unit_cm * rms.value("before", 0.0);
  metrics["plane_rms_after_cm"] = unit_cm * rms.value("after", 0.0);
}

}  // namespace

Metrics measure_reconstruction(const std::filesystem::path& folder, const SequenceTruth* truth) {
  const Reconstruction map = read_reconstruction(folder);
  Metrics metrics;
  count(map, metrics);
  add_stage_times(folder, metrics);
  if (truth == nullptr) return metrics;
  PlaneEvaluationOptions options;
  options.trajectory.align = map.metric ? Alignment::kSe3 : Alignment::kSim3;
  options.seen_labels = truth->seen_labels;
  measure_trajectories(map, *truth, options.trajectory, metrics);
  add_plane_rms(folder, metrics);
  if (truth->planes.empty()) return metrics;
  measure_planes(map, *truth, options, metrics);
  OverlayOptions overlay;
  overlay.planes = options;
  measure_overlay(map, *truth, overlay, metrics);
  return metrics;
}

}  // namespace planecast::engine
