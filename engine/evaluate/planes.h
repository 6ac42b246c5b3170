#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/evaluate/trajectory.h"
#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// When an estimated plane is a true one.
struct PlaneTolerance {
  double offset_m = 0.05;
  double angle_deg = 10.0;
};

struct PlaneEvaluationOptions {
  TrajectoryOptions trajectory;  ///< the alignment uses the trajectory alone
  std::array<PlaneTolerance, 2> tolerances = {PlaneTolerance{0.05, 10.0},
                                              PlaneTolerance{0.02, 5.0}};
  double min_overlap = 0.5;        ///< common area over the smaller of both
  double min_true_area_m2 = 0.05;  ///< smaller true patches need not be found
  double min_seen_share =
      0.25;  ///< of a true patch in the union of the views, or it need not be found
  /// A true plane that must be found by the third score: so many landmarks lie so near to it.
  int min_landmarks = 24;
  double landmark_distance_m = 0.02;
  int grid_cells = 48;  ///< areas are sampled on a grid of so many cells a side
  /// Labels of the true planes that the images show (visibility.h). Without it visibility is judged
  /// by the frustum and the normal alone, which knows no occlusion.
  std::optional<std::set<int>> seen_labels;
};

/// Counts and ratios at one tolerance.
struct PlaneScore {
  PlaneTolerance tolerance;
  int estimated = 0;
  int truth = 0;           ///< true planes that must be found: seen and large enough
  int matched = 0;         ///< of the estimated, one to one
  int found = 0;           ///< of the true ones that must be found
  double precision = 0.0;  ///< matched / estimated
  double recall = 0.0;     ///< found / truth
  double f = 0.0;
  int over_segmented = 0;  ///< further estimates that lie on a true plane already matched
  int under_segmented =
      0;  ///< true planes left over whose place is taken by an estimate matched elsewhere
};

/// One true plane and its counterpart: the match at the first tolerance, else, of a plane that must
/// be found, the estimate nearest to it that overlaps it, whichever way it faces.
struct TruePlaneRow {
  int truth_id = 0;
  int label = 0;
  std::string plane_class;
  double area_m2 = 0.0;
  bool required = false;  ///< seen and large enough
  int landmarks = 0;      ///< that lie on it, whoever owns them
  bool matched = false;
  int estimate_id = -1;    ///< -1: no estimate is near
  double angle_deg = 0.0;  ///< between the normals, 180 = flipped
  double offset_m = 0.0;   ///< signed, of the estimate's plane at the true patch's centroid
  double coverage = 0.0;   ///< share of the true patch under the estimate's polygon
};

/// Agreement of the points' grouping by plane with the truth's (nearest true patch within 5 cm).
struct PointLabelScore {
  int points = 0;
  double rand_index = 0.0;                ///< RI, 1 is best
  double variation_of_information = 0.0;  ///< VOI in nats, 0 is best
  double segmentation_covering = 0.0;     ///< SC, 1 is best
};

struct PlaneResult {
  TrajectoryResult trajectory;
  std::array<PlaneScore, 2> scores;
  /// At the first tolerance, over the true planes that also have PlaneEvaluationOptions's
  /// min_landmarks: what the map could know.
  PlaneScore supported;
  std::vector<TruePlaneRow> rows;
  Statistics angle_deg;    ///< of the matches at the first tolerance
  Statistics offset_m;     ///< absolute
  Statistics point_rms_m;  ///< distances of the points owned by a match to its true plane
  PointLabelScore labels;
};

/// Estimate and truth are aligned by their trajectories, positions and directions; an estimate
/// matches a true plane if the angle between the normals (which face the cameras: a flipped one is
/// wrong), the distance of its plane to the true patch's centroid and the overlap allow it; one to
/// one, largest common area first. `camera` is the true one. Nothing if the trajectories share
/// fewer than 3 poses.
std::optional<PlaneResult> evaluate_planes(const Reconstruction& estimate,
                                           const std::vector<PlaneRecord>& truth,
                                           const std::vector<TimedPose>& truth_poses,
                                           const slam::Camera& camera,
                                           const PlaneEvaluationOptions& options = {});

std::string format_table(const PlaneResult& result);
nlohmann::ordered_json to_json(const PlaneResult& result);

/// Final poses of a reconstruction.
std::vector<TimedPose> final_poses(const Reconstruction& reconstruction);

}  // namespace planecast::engine
