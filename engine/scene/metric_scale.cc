#include "engine/scene/metric_scale.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/hit_test.h"
#include "engine/scene/placement.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr std::size_t kFewPoints = 20;  ///< fewer visible points give no median worth its name

/// Median depth of the map points in one picture; nothing when there are too few.
std::optional<double> median_depth_in(const Reconstruction& reconstruction,
                                      const slam::Pose& world_from_cam) {
  const slam::Pose cam_from_world = world_from_cam.inverse();
  std::vector<double> depths;
  for (const MapPoint& point : reconstruction.points) {
    const Eigen::Vector3d p = cam_from_world * point.position;
    if (p.z() > 0.0 && reconstruction.camera.contains(reconstruction.camera.project(p))) {
      depths.push_back(p.z());
    }
  }
  if (depths.size() < kFewPoints) return std::nullopt;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

/// The frame from which the first object was placed, else the first one with a pose.
int placing_frame(const Reconstruction& reconstruction, const SceneFile& scene, bool causal,
                  const std::string& where) {
  if (const auto* place = std::get_if<PixelPlace>(&scene.objects.front().place))
    return place->frame;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (causal ? frame.causal_world_from_cam : frame.world_from_cam) return frame.index;
  }
  throw UserError(where + ": no frame has a camera pose");
}

/// Length of the thing in the map.
double map_length(const Reconstruction& reconstruction, const SceneFile& scene,
                  const PlaneDistanceScale& rule, bool causal, const std::string& where) {
  const int frame = rule.frame.value_or(placing_frame(reconstruction, scene, causal, where));
  const Eigen::Vector3d viewer = frame_pose(reconstruction, frame, causal, where).translation();
  const SceneObject& object = scene.objects.front();
  const PlaneRecord* plane = nullptr;
  if (const auto* pixel = std::get_if<PixelPlace>(&object.place)) {
    const Hit hit = tap(reconstruction, pixel->frame, pixel->pixel, causal, object.where);
    plane = find_plane(reconstruction.planes, hit.plane_id);
  } else if (const auto* by_plane = std::get_if<PlanePlace>(&object.place)) {
    plane = &select_plane(reconstruction, by_plane->plane, object.where);
  } else {
    throw UserError(where + ": 'plane_distance' needs the first object to be placed on a plane");
  }
  return std::abs(plane->normal.dot(viewer) + plane->offset);
}

double map_length(const Reconstruction& reconstruction, const SceneFile& /*scene*/,
                  const EdgeScale& rule, bool causal, const std::string& where) {
  const Hit from = tap(reconstruction, rule.frame, rule.from, causal, where);
  const Hit to = tap(reconstruction, rule.frame, rule.to, causal, where);
  return (to.point - from.point).norm();
}

double known_length(const PlaneDistanceScale& rule) { return rule.distance_m; }
double known_length(const EdgeScale& rule) { return rule.length_m; }

}  // namespace

SizeUnit size_unit(const Reconstruction& reconstruction, const SceneFile& scene,
                   const SceneObject& object, bool causal) {
  SizeUnit unit;
  unit.median_depth = reconstruction.median_depth;
  if (reconstruction.metric) {
    unit.units_per_metre = 1.0;
    return unit;
  }
  if (scene.scale) {
    const std::string& where = scene.scale->where;
    unit.units_per_metre = std::visit(
        [&](const auto& rule) {
          return map_length(reconstruction, scene, rule, causal, where) / known_length(rule);
        },
        scene.scale->rule);
    if (!(unit.units_per_metre > 0.0))
      throw UserError(where + ": the known length is zero in the map");
    return unit;
  }
  const auto* place = std::get_if<PixelPlace>(&object.place);
  if (causal && place != nullptr) {
    const slam::Pose pose = frame_pose(reconstruction, place->frame, causal, object.where);
    unit.median_depth = median_depth_in(reconstruction, pose).value_or(reconstruction.median_depth);
  }
  return unit;
}

}  // namespace planecast::engine
