#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/evaluate/statistics.h"
#include "engine/sequence/sequence.h"
#include "slam/geometry/sim3.h"

namespace planecast::engine {

enum class Alignment { kSe3, kSim3 };

struct TrajectoryOptions {
  Alignment align = Alignment::kSim3;
  double max_difference_s = 0.02;  ///< of paired times, as in the TUM benchmark's tools
  double rpe_delta_s = 1.0;        ///< drift is measured over this time
};

/// Errors of an estimated trajectory, in the truth's unit (metres).
struct TrajectoryResult {
  int estimated = 0;
  int pairs = 0;
  slam::Similarity truth_from_estimate;  ///< least squares over the positions (Umeyama 1991)
  /// The same with the cameras' directions counted too, each as points 1 m along its axes: what
  /// the map is compared by, since the positions of a nearly straight path leave a turn about it
  /// open.
  slam::Similarity truth_from_estimate_by_poses;
  Statistics ate;              ///< distances of aligned positions (Sturm et al. 2012, section V.B)
  Statistics rpe_translation;  ///< over rpe_delta_s (section V.A); count 0 if no two poses are so
                               ///< far apart
  Statistics rpe_rotation_deg;
  bool nearly_straight = false;  ///< the positions leave the rotation about their line undetermined
};

/// Pairs (index of a, index of b) by time: greedy one-to-one in order of difference. Times ascend.
std::vector<std::pair<int, int>> associate(const std::vector<TimedPose>& a,
                                           const std::vector<TimedPose>& b,
                                           double max_difference_s);

/// Nothing if there are fewer than 3 pairs.
std::optional<TrajectoryResult> evaluate_trajectory(const std::vector<TimedPose>& estimate,
                                                    const std::vector<TimedPose>& truth,
                                                    const TrajectoryOptions& options = {});

std::string format_table(const TrajectoryResult& result);
nlohmann::ordered_json to_json(const TrajectoryResult& result);
nlohmann::ordered_json to_json(const Statistics& statistics);

}  // namespace planecast::engine
