#include "engine/evaluate/planes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/evaluate/patch.h"
#include "engine/evaluate/plane_matching.h"

namespace planecast::engine {
namespace {

/// A true plane without a match is shown with an estimate up to so far away.
constexpr double kNearEnough_m = 0.5;
/// A point this near to a true patch lies on it.
constexpr double kOnPatch_m = 0.05;

/// The estimate brought into the true world.
struct AlignedMap {
  std::vector<PlaneRecord> planes;
  std::vector<MapPoint> points;
};

AlignedMap align(const Reconstruction& estimate, const slam::Similarity& truth_from_estimate) {
  AlignedMap map;
  for (const PlaneRecord& plane : estimate.planes) {
    map.planes.push_back(transformed(truth_from_estimate, plane));
  }
  map.points = estimate.points;
  for (MapPoint& point : map.points) point.position = truth_from_estimate * point.position;
  return map;
}

std::vector<char> required_planes(const std::vector<PlaneRecord>& truth,
                                  const std::vector<TimedPose>& poses, const slam::Camera& camera,
                                  const PlaneEvaluationOptions& options) {
  std::vector<char> required = planes_in_view(truth, poses, camera, options.min_seen_share);
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (options.seen_labels) required[t] = options.seen_labels->contains(truth[t].label) ? 1 : 0;
    if (Patch(truth[t]).area() < options.min_true_area_m2) required[t] = 0;
  }
  return required;
}

PlaneScore score_matches(const std::vector<int>& truth_of, const RelationTable& relations,
                         const std::vector<char>& required, const PlaneTolerance& tolerance,
                         double min_overlap) {
  PlaneScore score;
  score.tolerance = tolerance;
  score.estimated = static_cast<int>(truth_of.size());
  score.truth = static_cast<int>(std::count(required.begin(), required.end(), 1));
  std::vector<char> taken(required.size(), 0);
  for (const int t : truth_of) {
    if (t < 0) continue;
    taken[static_cast<std::size_t>(t)] = 1;
    ++score.matched;
    score.found += required[static_cast<std::size_t>(t)];
  }
  std::vector<char> merged(required.size(), 0);
  for (std::size_t e = 0; e < truth_of.size(); ++e) {
    bool on_taken = false;
    for (std::size_t t = 0; t < required.size(); ++t) {
      if (!relations[e][t].within(tolerance, min_overlap)) continue;
      if (truth_of[e] < 0 && taken[t] != 0) on_taken = true;
      if (truth_of[e] >= 0 && taken[t] == 0) merged[t] = required[t];
    }
    if (on_taken) ++score.over_segmented;
  }
  score.under_segmented = static_cast<int>(std::count(merged.begin(), merged.end(), 1));
  if (score.estimated > 0) score.precision = static_cast<double>(score.matched) / score.estimated;
  if (score.truth > 0) score.recall = static_cast<double>(score.found) / score.truth;
  const double sum = score.precision + score.recall;
  if (sum > 0.0) score.f = 2.0 * score.precision * score.recall / sum;
  return score;
}

int nearest_estimate(const RelationTable& relations, std::size_t t, double min_overlap) {
  int nearest = -1;
  double distance = kNearEnough_m;
  for (std::size_t e = 0; e < relations.size(); ++e) {
    const PlaneRelation& relation = relations[e][t];
    const bool parallel = std::abs(std::cos(relation.angle_deg * std::acos(-1.0) / 180.0)) > 0.7;
    if (!parallel || relation.overlap < min_overlap || std::abs(relation.offset_m) >= distance) {
      continue;
    }
    distance = std::abs(relation.offset_m);
    nearest = static_cast<int>(e);
  }
  return nearest;
}

std::vector<TruePlaneRow> describe_truth(const AlignedMap& map,
                                         const std::vector<PlaneRecord>& truth,
                                         const std::vector<char>& required,
                                         const std::vector<int>& landmarks,
                                         const RelationTable& relations,
                                         const std::vector<int>& truth_of, double min_overlap) {
  std::vector<TruePlaneRow> rows;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    TruePlaneRow row;
    row.truth_id = truth[t].id;
    row.label = truth[t].label;
    row.plane_class = truth[t].plane_class;
    row.area_m2 = Patch(truth[t]).area();
    row.required = required[t] != 0;
    row.landmarks = landmarks[t];
    const auto match = std::find(truth_of.begin(), truth_of.end(), static_cast<int>(t));
    row.matched = match != truth_of.end();
    int e = -1;
    if (row.matched) {
      e = static_cast<int>(match - truth_of.begin());
    } else if (row.required) {
      e = nearest_estimate(relations, t, min_overlap);
    }
    if (e >= 0) {
      const PlaneRelation& relation = relations[static_cast<std::size_t>(e)][t];
      row.estimate_id = map.planes[static_cast<std::size_t>(e)].id;
      row.angle_deg = relation.angle_deg;
      row.offset_m = relation.offset_m;
      row.coverage = relation.coverage;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Statistics distances_to_truth(const AlignedMap& map, const std::vector<PlaneRecord>& truth,
                              const std::vector<int>& truth_of) {
  std::vector<double> distances;
  for (std::size_t e = 0; e < truth_of.size(); ++e) {
    if (truth_of[e] < 0) continue;
    const PlaneRecord& plane = truth[static_cast<std::size_t>(truth_of[e])];
    for (const MapPoint& point : map.points) {
      if (point.plane != map.planes[e].id) continue;
      distances.push_back(std::abs(plane.normal.dot(point.position) + plane.offset));
    }
  }
  return statistics_of(distances);
}

std::vector<int> nearest_true_patch(const std::vector<MapPoint>& points,
                                    const std::vector<PlaneRecord>& truth) {
  const std::vector<Patch> patches(truth.begin(), truth.end());
  std::vector<int> nearest;
  for (const MapPoint& point : points) {
    int best = -1;
    double best_distance = kOnPatch_m;
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double distance = std::abs(truth[t].normal.dot(point.position) + truth[t].offset);
      if (distance > best_distance || !patches[t].contains(point.position)) continue;
      best_distance = distance;
      best = static_cast<int>(t);
    }
    nearest.push_back(best);
  }
  return nearest;
}

/// Of each true patch, the landmarks within `distance_m` of it, whatever else they are near to.
std::vector<int> landmarks_on(const std::vector<PlaneRecord>& truth,
                              const std::vector<MapPoint>& points, double distance_m) {
  std::vector<int> counts;
  for (const PlaneRecord& plane : truth) {
    const Patch patch(plane);
    const auto lies_on = [&](const MapPoint& point) {
      return std::abs(plane.normal.dot(point.position) + plane.offset) <= distance_m &&
             patch.contains(point.position);
    };
    counts.push_back(static_cast<int>(std::count_if(points.begin(), points.end(), lies_on)));
  }
  return counts;
}

std::string format_row(const PlaneScore& s) {
  return fmt::format(
      "{:4.0f} cm {:3.0f} deg {:>9} {:>6} {:>6} {:>5} {:>9.3f} {:>7.3f} {:>6.3f} {:>5} {:>5}\n",
      100.0 * s.tolerance.offset_m, s.tolerance.angle_deg, s.estimated, s.truth, s.matched, s.found,
      s.precision, s.recall, s.f, s.over_segmented, s.under_segmented);
}

nlohmann::ordered_json to_json(const PlaneScore& score) {
  nlohmann::ordered_json json;
  json["offset_m"] = score.tolerance.offset_m;
  json["angle_deg"] = score.tolerance.angle_deg;
  json["estimated"] = score.estimated;
  json["truth"] = score.truth;
  json["matched"] = score.matched;
  json["found"] = score.found;
  json["precision"] = score.precision;
  json["recall"] = score.recall;
  json["f"] = score.f;
  json["over_segmented"] = score.over_segmented;
  json["under_segmented"] = score.under_segmented;
  return json;
}

nlohmann::ordered_json to_json(const TruePlaneRow& row) {
  nlohmann::ordered_json json;
  json["truth_id"] = row.truth_id;
  json["label"] = row.label;
  json["class"] = row.plane_class;
  json["area_m2"] = row.area_m2;
  json["required"] = row.required;
  json["landmarks"] = row.landmarks;
  json["matched"] = row.matched;
  json["estimate_id"] = row.estimate_id;
  json["angle_deg"] = row.angle_deg;
  json["offset_m"] = row.offset_m;
  json["coverage"] = row.coverage;
  return json;
}

}  // namespace

std::vector<TimedPose> final_poses(const Reconstruction& reconstruction) {
  std::vector<TimedPose> poses;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (frame.world_from_cam) poses.push_back({frame.timestamp, *frame.world_from_cam});
  }
  return poses;
}

std::optional<PlaneResult> evaluate_planes(const Reconstruction& estimate,
                                           const std::vector<PlaneRecord>& truth,
                                           const std::vector<TimedPose>& truth_poses,
                                           const slam::Camera& camera,
                                           const PlaneEvaluationOptions& options) {
  const auto trajectory =
      evaluate_trajectory(final_poses(estimate), truth_poses, options.trajectory);
  if (!trajectory) return std::nullopt;
  PlaneResult result;
  result.trajectory = *trajectory;
  const AlignedMap map = align(estimate, trajectory->truth_from_estimate_by_poses);
  const RelationTable relations = relate_planes(map.planes, map.points, truth, options.grid_cells);
  const std::vector<char> required = required_planes(truth, truth_poses, camera, options);
  for (std::size_t level = 0; level < options.tolerances.size(); ++level) {
    const PlaneTolerance& tolerance = options.tolerances[level];
    const std::vector<int> truth_of =
        match_planes(relations, truth.size(), tolerance, options.min_overlap);
    result.scores[level] =
        score_matches(truth_of, relations, required, tolerance, options.min_overlap);
  }
  const std::vector<int> truth_of =
      match_planes(relations, truth.size(), options.tolerances[0], options.min_overlap);
  const std::vector<int> landmarks = landmarks_on(truth, map.points, options.landmark_distance_m);
  std::vector<char> supported = required;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (landmarks[t] < options.min_landmarks) supported[t] = 0;
  }
  result.supported =
      score_matches(truth_of, relations, supported, options.tolerances[0], options.min_overlap);
  result.rows =
      describe_truth(map, truth, required, landmarks, relations, truth_of, options.min_overlap);
  std::vector<double> angles;
  std::vector<double> offsets;
  for (const TruePlaneRow& row : result.rows) {
    if (!row.matched) continue;
    angles.push_back(row.angle_deg);
    offsets.push_back(std::abs(row.offset_m));
  }
  result.angle_deg = statistics_of(angles);
  result.offset_m = statistics_of(offsets);
  result.point_rms_m = distances_to_truth(map, truth, truth_of);
  result.labels = score_point_labels(map.points, nearest_true_patch(map.points, truth));
  return result;
}

std::string format_table(const PlaneResult& result) {
  std::string text = fmt::format("{:14} {:>9} {:>6} {:>6} {:>5} {:>9} {:>7} {:>6} {:>5} {:>5}\n",
                                 "tolerance", "estimated", "truth", "match", "found", "precision",
                                 "recall", "F", "over", "under");
  for (const PlaneScore& score : result.scores) text += format_row(score);
  text += "of the true planes with enough landmarks:\n" + format_row(result.supported);
  text +=
      fmt::format("\n{:>5} {:>10} {:>8} {:>9} {:>8} {:>8} {:>10} {:>10} {:>8}\n", "truth", "class",
                  "area m2", "landmarks", "estimate", "state", "angle deg", "offset cm", "covered");
  for (const TruePlaneRow& row : result.rows) {
    const char* state = row.matched ? "match" : row.required ? "missed" : "unseen";
    text += fmt::format("{:>5} {:>10} {:>8.2f} {:>9} {:>8} {:>8}", row.truth_id, row.plane_class,
                        row.area_m2, row.landmarks, row.estimate_id, state);
    text += row.estimate_id < 0 ? "\n"
                                : fmt::format(" {:>10.2f} {:>10.2f} {:>7.0f}%\n", row.angle_deg,
                                              100.0 * row.offset_m, 100.0 * row.coverage);
  }
  text +=
      fmt::format("\nangle deg: median {:.3f}, p90 {:.3f}; offset cm: median {:.3f}, p90 {:.3f}\n",
                  result.angle_deg.median, result.angle_deg.p90, 100.0 * result.offset_m.median,
                  100.0 * result.offset_m.p90);
  text += fmt::format(
      "points to their true plane: rms {:.3f} cm; labels: RI {:.3f}, VOI {:.3f}, SC {:.3f}\n",
      100.0 * result.point_rms_m.rms, result.labels.rand_index,
      result.labels.variation_of_information, result.labels.segmentation_covering);
  return text;
}

nlohmann::ordered_json to_json(const PlaneResult& result) {
  nlohmann::ordered_json json;
  json["trajectory"] = to_json(result.trajectory);
  for (const PlaneScore& score : result.scores) json["scores"].push_back(to_json(score));
  json["supported"] = to_json(result.supported);
  json["planes"] = nlohmann::ordered_json::array();
  for (const TruePlaneRow& row : result.rows) json["planes"].push_back(to_json(row));
  json["angle_deg"] = to_json(result.angle_deg);
  json["offset_m"] = to_json(result.offset_m);
  json["points_to_true_plane_m"] = to_json(result.point_rms_m);
  json["rand_index"] = result.labels.rand_index;
  json["variation_of_information"] = result.labels.variation_of_information;
  json["segmentation_covering"] = result.labels.segmentation_covering;
  return json;
}

}  // namespace planecast::engine
