#include "engine/evaluate/trajectory.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/sequence/list_file.h"

namespace planecast::engine {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

/// Below this ratio of the second to the first extent, positions lie on a line.
constexpr double kStraight = 0.01;
constexpr double kDegrees = 180.0 / std::numbers::pi;
/// Where a camera's direction is measured.
constexpr double kReach_m = 1.0;

std::vector<double> times_of(const std::vector<TimedPose>& poses) {
  std::vector<double> times;
  for (const TimedPose& pose : poses) times.push_back(pose.timestamp);
  return times;
}

bool is_nearly_straight(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues();
  return variances[1] <= kStraight * kStraight * variances[2];
}

/// For pair i, the pair whose time in the estimate is nearest to delta later; -1 if none is within
/// the tolerance.
int partner_after(const std::vector<double>& times, std::size_t i, double delta, double tolerance) {
  const double wanted = times[i] + delta;
  const auto above = std::lower_bound(times.begin(), times.end(), wanted);
  int best = -1;
  double best_difference = tolerance;
  for (auto it = above == times.begin() ? above : above - 1; it != times.end() && it <= above;
       ++it) {
    if (const double difference = std::abs(*it - wanted); difference <= best_difference) {
      best_difference = difference;
      best = static_cast<int>(it - times.begin());
    }
  }
  return best > static_cast<int>(i) ? best : -1;
}

slam::Pose relative(const slam::Pose& from, const slam::Pose& to) { return from.inverse() * to; }

void measure_rpe(const std::vector<TimedPose>& estimate, const std::vector<TimedPose>& truth,
                 const Pairs& pairs, const TrajectoryOptions& options, TrajectoryResult& result) {
  std::vector<double> times;
  for (const auto& [e, t] : pairs) times.push_back(estimate[static_cast<std::size_t>(e)].timestamp);
  std::vector<double> translations;
  std::vector<double> rotations_deg;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int j = partner_after(times, i, options.rpe_delta_s, options.max_difference_s);
    if (j < 0) continue;
    const auto pose_of = [](const std::vector<TimedPose>& poses, int index) -> const slam::Pose& {
      return poses[static_cast<std::size_t>(index)].world_from_cam;
    };
    const auto& [e_from, t_from] = pairs[i];
    const auto& [e_to, t_to] = pairs[static_cast<std::size_t>(j)];
    slam::Pose moved = relative(pose_of(estimate, e_from), pose_of(estimate, e_to));
    moved.translation() *= result.truth_from_estimate.scale;
    const slam::Pose error =
        relative(relative(pose_of(truth, t_from), pose_of(truth, t_to)), moved);
    translations.push_back(error.translation().norm());
    rotations_deg.push_back(kDegrees * Eigen::AngleAxisd(error.linear()).angle());
  }
  result.rpe_translation = statistics_of(translations);
  result.rpe_rotation_deg = statistics_of(rotations_deg);
}

/// Rigid alignment of positions and directions at the scale that the positions gave.
slam::Similarity align_poses(const std::vector<TimedPose>& estimate,
                             const std::vector<TimedPose>& truth, const Pairs& pairs,
                             double scale) {
  std::vector<Eigen::Vector3d> source;
  std::vector<Eigen::Vector3d> target;
  const auto add = [](slam::Pose pose, double unit_m, std::vector<Eigen::Vector3d>& points) {
    pose.translation() *= unit_m;
    points.emplace_back(pose.translation());
    for (int axis = 0; axis < 3; ++axis) {
      points.emplace_back(pose * (kReach_m * Eigen::Vector3d::Unit(axis)));
    }
  };
  for (const auto& [e, t] : pairs) {
    add(estimate[static_cast<std::size_t>(e)].world_from_cam, scale, source);
    add(truth[static_cast<std::size_t>(t)].world_from_cam, 1.0, target);
  }
  slam::Similarity result = slam::align_points(source, target, false);
  result.scale = scale;
  return result;
}

}  // namespace

Pairs associate(const std::vector<TimedPose>& a, const std::vector<TimedPose>& b,
                double max_difference_s) {
  Pairs pairs;
  const std::vector<int> partner = pair_by_time(times_of(a), times_of(b), max_difference_s);
  for (std::size_t i = 0; i < partner.size(); ++i) {
    if (partner[i] >= 0) pairs.emplace_back(static_cast<int>(i), partner[i]);
  }
  return pairs;
}

std::optional<TrajectoryResult> evaluate_trajectory(const std::vector<TimedPose>& estimate,
                                                    const std::vector<TimedPose>& truth,
                                                    const TrajectoryOptions& options) {
  const Pairs pairs = associate(estimate, truth, options.max_difference_s);
  if (pairs.size() < 3) return std::nullopt;
  std::vector<Eigen::Vector3d> source;
  std::vector<Eigen::Vector3d> target;
  for (const auto& [e, t] : pairs) {
    source.emplace_back(estimate[static_cast<std::size_t>(e)].world_from_cam.translation());
    target.emplace_back(truth[static_cast<std::size_t>(t)].world_from_cam.translation());
  }
  TrajectoryResult result;
  result.estimated = static_cast<int>(estimate.size());
  result.pairs = static_cast<int>(pairs.size());
  result.truth_from_estimate =
      slam::align_points(source, target, options.align == Alignment::kSim3);
  result.truth_from_estimate_by_poses =
      align_poses(estimate, truth, pairs, result.truth_from_estimate.scale);
  result.nearly_straight = is_nearly_straight(source);
  std::vector<double> distances;
  for (std::size_t i = 0; i < source.size(); ++i) {
    distances.push_back((result.truth_from_estimate * source[i] - target[i]).norm());
  }
  result.ate = statistics_of(distances);
  measure_rpe(estimate, truth, pairs, options, result);
  return result;
}

std::string format_table(const TrajectoryResult& result) {
  std::string text = fmt::format("pairs                {:>12} of {} estimated poses\n",
                                 result.pairs, result.estimated);
  text += fmt::format("scale applied        {:>12.5f}\n", result.truth_from_estimate.scale);
  text += fmt::format("{:20} {:>12} {:>12} {:>12} {:>12}\n", "", "rmse", "mean", "median", "max");
  const auto row = [](const char* name, const Statistics& s) {
    return fmt::format("{:20} {:>12.6f} {:>12.6f} {:>12.6f} {:>12.6f}\n", name, s.rms, s.mean,
                       s.median, s.max);
  };
  text += row("ATE [m]", result.ate);
  if (result.rpe_translation.count > 0) {
    text += row("RPE [m]", result.rpe_translation);
    text += row("RPE [deg]", result.rpe_rotation_deg);
  }
  if (result.nearly_straight) {
    text += "the path is nearly straight: its alignment leaves a rotation undetermined\n";
  }
  return text;
}

nlohmann::ordered_json to_json(const Statistics& statistics) {
  nlohmann::ordered_json json;
  json["count"] = statistics.count;
  json["rmse"] = statistics.rms;
  json["mean"] = statistics.mean;
  json["median"] = statistics.median;
  json["p90"] = statistics.p90;
  json["p95"] = statistics.p95;
  json["max"] = statistics.max;
  return json;
}

nlohmann::ordered_json to_json(const TrajectoryResult& result) {
  nlohmann::ordered_json json;
  json["estimated"] = result.estimated;
  json["pairs"] = result.pairs;
  json["scale"] = result.truth_from_estimate.scale;
  json["ate_m"] = to_json(result.ate);
  json["rpe_m"] = to_json(result.rpe_translation);
  json["rpe_deg"] = to_json(result.rpe_rotation_deg);
  json["nearly_straight"] = result.nearly_straight;
  return json;
}

}  // namespace planecast::engine
