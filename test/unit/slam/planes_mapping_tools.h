#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "planes_world.h"
#include "slam/stages/map_planes.h"

namespace planecast::slam {

/// Runs the plane steps at each keyframe as local mapping does.
inline PlaneMappingStats map_planes(Map& map, const std::vector<KeyframeId>& keyframes,
                                    PlaneMapper& mapper) {
  PlaneMappingStats stats;
  for (const KeyframeId id : keyframes) {
    mapper.cull_non_planar(map, id, stats);
    mapper.update(map, id, stats);
  }
  return stats;
}

inline PlaneMapper mono_mapper(const PlaneMappingOptions& options = {}) {
  return PlaneMapper(options, test_camera(), false);
}

inline double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// Planes of the map within 5 degrees and `tolerance` of the patch at `centre` with unit normal
/// `normal`.
inline int count_matching(const Map& map, const Eigen::Vector3d& normal,
                          const Eigen::Vector3d& centre, double tolerance) {
  int count = 0;
  for (const Plane& plane : map.planes) {
    count += angle_deg(plane.normal, normal) < 5.0 &&
             std::abs(plane.signed_distance(centre)) < tolerance;
  }
  return count;
}

inline void add_all(MapBuilder& builder, const std::vector<Eigen::Vector3d>& points,
                    const std::vector<KeyframeId>& observers, int label) {
  for (const Eigen::Vector3d& p : points) builder.add_landmark(p, observers, label);
}

/// Two cameras side by side at the origin that look ahead and a little down.
inline std::vector<KeyframeId> add_pair(MapBuilder& builder, const Eigen::Vector3d& centre,
                                        const Eigen::Vector3d& target) {
  return {builder.add_keyframe(look_at(centre, target)),
          builder.add_keyframe(look_at(centre + Eigen::Vector3d(0.1, 0, 0), target))};
}

inline const Eigen::Vector3d kUp(0, -1, 0);  ///< y runs down

}  // namespace planecast::slam
