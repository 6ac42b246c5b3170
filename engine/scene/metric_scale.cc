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

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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
  return median(depths);
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

/// What a rule of the scene file is looked up in.
struct Ruler {
  const PlacingWorld& world;
  const SceneFile& scene;
  const std::string& where;

  Eigen::Vector3d camera_at(int frame) const {
    return frame_pose(world.map, frame, world.causal, where).translation();
  }
  Hit tap_at(int frame, const Eigen::Vector2d& pixel) const {
    return tap(world.map, frame, pixel, world.causal, where);
  }
};

double height_over(const PlaneRecord& plane, const Eigen::Vector3d& point) {
  return std::abs(plane.normal.dot(point) + plane.offset);
}

/// Length in the map of what the rule knows the metres of.
double map_length(const Ruler& ruler, const PlaneDistanceScale& rule) {
  const Reconstruction& map = ruler.world.map;
  const int frame =
      rule.frame.value_or(placing_frame(map, ruler.scene, ruler.world.causal, ruler.where));
  const Eigen::Vector3d viewer = ruler.camera_at(frame);
  const SceneObject& object = ruler.scene.objects.front();
  if (const auto* pixel = std::get_if<PixelPlace>(&object.place)) {
    const Hit hit = ruler.tap_at(pixel->frame, pixel->pixel);
    const auto planes = planes_at(map, pixel->frame, ruler.world.causal);
    return height_over(*find_plane(planes, hit.plane_id), viewer);
  }
  if (const auto* by_plane = std::get_if<PlanePlace>(&object.place)) {
    return height_over(select_plane(map, by_plane->plane, object.where), viewer);
  }
  throw UserError(ruler.where +
                  ": 'plane_distance' needs the first object to be placed on a plane");
}

double map_length(const Ruler& ruler, const EdgeScale& rule) {
  const Hit from = ruler.tap_at(rule.frame, rule.from);
  const Hit to = ruler.tap_at(rule.frame, rule.to);
  return (to.point - from.point).norm();
}

/// The top is the point on the ray of its pixel that is nearest to the upright line over the foot.
double map_length(const Ruler& ruler, const HeightScale& rule) {
  const Reconstruction& map = ruler.world.map;
  const Hit foot = ruler.tap_at(rule.frame, rule.foot);
  const auto planes = planes_at(map, rule.frame, ruler.world.causal);
  const Eigen::Vector3d up = find_plane(planes, foot.plane_id)->normal;
  const slam::Pose pose = frame_pose(map, rule.frame, ruler.world.causal, ruler.where);
  const Ray ray = pixel_ray(map.camera, pose, rule.top);
  const Eigen::Vector3d d = ray.direction.normalized();
  const double cosine = up.dot(d);
  const Eigen::Vector3d between = ray.origin - foot.point;
  const double sine2 = 1.0 - cosine * cosine;
  if (sine2 < 1e-4) throw UserError(ruler.where + ": 'object' is seen from right above");
  return (up.dot(between) - cosine * d.dot(between)) / sine2;
}

double map_length(const Ruler& ruler, const MarkerScale& rule) {
  return select_marker(ruler.world.markers, rule.marker, ruler.where).side();
}

double map_length(const Ruler& ruler, const CameraHeightScale& rule) {
  const Reconstruction& map = ruler.world.map;
  const bool has_floor = std::ranges::any_of(
      map.planes, [](const PlaneRecord& plane) { return plane.plane_class == "floor"; });
  const PlaneRecord& floor =
      select_plane(map, has_floor ? "floor" : "largest-horizontal", ruler.where);
  if (rule.frame) return height_over(floor, ruler.camera_at(*rule.frame));
  std::vector<double> heights;
  for (const FrameRecord& frame : map.frames) {
    const auto& pose = ruler.world.causal ? frame.causal_world_from_cam : frame.world_from_cam;
    if (pose) heights.push_back(height_over(floor, pose->translation()));
  }
  if (heights.empty()) throw UserError(ruler.where + ": no frame has a camera pose");
  return median(heights);
}

double known_length(const PlaneDistanceScale& rule) { return rule.distance_m; }
double known_length(const EdgeScale& rule) { return rule.length_m; }
double known_length(const HeightScale& rule) { return rule.height_m; }
double known_length(const MarkerScale& rule) { return rule.size_m; }
double known_length(const CameraHeightScale& rule) { return rule.height_m; }

}  // namespace

SizeUnit size_unit(const PlacingWorld& world, const SceneFile& scene, const SceneObject& object) {
  SizeUnit unit;
  unit.median_depth = world.map.median_depth;
  if (world.map.metric) {
    unit.units_per_metre = 1.0;
    return unit;
  }
  if (scene.scale) {
    const std::string& where = scene.scale->where;
    const Ruler ruler{world, scene, where};
    unit.units_per_metre = std::visit(
        [&ruler](const auto& rule) { return map_length(ruler, rule) / known_length(rule); },
        scene.scale->rule);
    if (!(unit.units_per_metre > 0.0))
      throw UserError(where + ": the known length is zero in the map");
    return unit;
  }
  const auto* place = std::get_if<PixelPlace>(&object.place);
  if (world.causal && place != nullptr) {
    const slam::Pose pose = frame_pose(world.map, place->frame, true, object.where);
    unit.median_depth = median_depth_in(world.map, pose).value_or(unit.median_depth);
  }
  return unit;
}

}  // namespace planecast::engine
