#pragma once

#include <vector>

#include "engine/evaluate/patch.h"
#include "engine/evaluate/planes.h"

namespace planecast::engine {

/// How an estimated plane lies to a true one, both in the true world.
struct PlaneRelation {
  double angle_deg = 0.0;
  double offset_m = 0.0;  ///< signed, at the true patch's centroid
  double common_area_m2 = 0.0;
  double overlap = 0.0;   ///< common area over the smaller area
  double coverage = 0.0;  ///< common area over the true area

  bool within(const PlaneTolerance& tolerance, double min_overlap) const;
};

/// [estimate][truth]. An estimate without a polygon is represented by the points it owns.
using RelationTable = std::vector<std::vector<PlaneRelation>>;
RelationTable relate_planes(const std::vector<PlaneRecord>& estimated,
                            const std::vector<MapPoint>& points,
                            const std::vector<PlaneRecord>& truth, int grid_cells);

/// Index of the true plane of each estimate, or -1: one to one, largest common area first.
std::vector<int> match_planes(const RelationTable& relations, std::size_t num_truth,
                              const PlaneTolerance& tolerance, double min_overlap);

/// Which true planes some pose sees with at least `min_share` of their area, taken over all poses.
std::vector<char> planes_in_view(const std::vector<PlaneRecord>& truth,
                                 const std::vector<TimedPose>& poses, const slam::Camera& camera,
                                 double min_share);

/// RI, VOI and SC of the points' plane ids against `truth_of_point` (index of a true plane or -1).
PointLabelScore score_point_labels(const std::vector<MapPoint>& points,
                                   const std::vector<int>& truth_of_point);

/// Whether a world point lies in front of the camera and inside its image.
bool is_in_view(const slam::Pose& world_from_cam, const slam::Camera& camera,
                const Eigen::Vector3d& point);

}  // namespace planecast::engine
