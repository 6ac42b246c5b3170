#include "engine/scene/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/scene/hit_test.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"

namespace planecast::engine {

double length_unit(const SceneObject& object, const SizeUnit& unit) {
  const bool known = unit.units_per_metre > 0.0;
  if (object.unit == LengthUnit::kMetres && !known) {
    throw UserError(object.where + ": 'size' in metres needs a scale, and the map has none");
  }
  return known && object.unit != LengthUnit::kRelative ? unit.units_per_metre : unit.median_depth;
}

namespace {

constexpr double kVerticalCosine = 0.7071;  ///< normals farther than 45 degrees from up are walls'
constexpr double kUsableUp = 0.1;           ///< confidence below which the up direction is not used
constexpr double kDefaultSize = 0.25;       ///< of the median depth, for maps without scale

/// What the kinds of place have in common once resolved.
struct Spot {
  std::optional<PlaneRecord> plane;  ///< none: a free point of the world
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
  Eigen::Vector3d x_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d viewer = Eigen::Vector3d::Zero();  ///< whom content faces
  bool vertical = false;
  std::optional<Tap> tap;
};

/// Part of `v` at right angles to the unit vector `normal`, normalised; nothing when they are
/// parallel.
std::optional<Eigen::Vector3d> tangent(const Eigen::Vector3d& v, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d flat = v - normal.dot(v) * normal;
  if (flat.norm() < 1e-3 * v.norm() || v.norm() == 0.0) return std::nullopt;
  return flat.normalized();
}

Eigen::Vector3d any_tangent(const Eigen::Vector3d& normal) { return normal.unitOrthogonal(); }

Spot spot_on(const Reconstruction& reconstruction, const PlaneRecord& plane,
             const Eigen::Vector3d& point, const Eigen::Vector3d& viewer) {
  Spot spot;
  spot.plane = plane;
  spot.point = point;
  spot.normal = plane.normal;
  spot.x_axis = plane.x_axis;
  spot.viewer = viewer;
  spot.vertical = is_vertical(reconstruction, plane);
  return spot;
}

Spot resolve(const PlacingWorld& world, const PixelPlace& place, const std::string& where) {
  const Hit hit = tap(world.map, place.frame, place.pixel, world.causal, where);
  const std::vector<PlaneRecord> planes = planes_at(world.map, place.frame, world.causal);
  Spot spot = spot_on(world.map, *find_plane(planes, hit.plane_id), hit.point,
                      frame_pose(world.map, place.frame, world.causal, where).translation());
  const slam::Camera& camera = world.map.camera;
  spot.tap = Tap{place.frame, camera.ray(camera.undistort(place.pixel))};
  return spot;
}

Spot resolve(const PlacingWorld& world, const PlanePlace& place, const std::string& where) {
  const PlaneRecord& plane = select_plane(world.map, place.plane, where);
  const Eigen::AlignedBox2d box = bounding_box(plane_outline(plane));
  if (box.isEmpty()) {
    throw UserError(where + ": plane " + std::to_string(plane.id) + " has no outline to place on");
  }
  const Eigen::Vector2d at = box.min() + place.at.cwiseProduct(box.sizes());
  const Eigen::Vector3d point = plane.world_from_plane() * Eigen::Vector3d(at.x(), at.y(), 0.0);
  return spot_on(world.map, plane, point, mean_camera_position(world.map));
}

/// A point and normal of the world that no plane of the map carries.
Spot free_spot(const Reconstruction& map, const Eigen::Vector3d& point,
               const Eigen::Vector3d& normal) {
  Spot spot;
  spot.point = point;
  spot.normal = normal;
  spot.x_axis = tangent(Eigen::Vector3d::UnitX(), normal).value_or(any_tangent(normal));
  spot.viewer = mean_camera_position(map);
  spot.vertical = map.up_confidence > kUsableUp && std::abs(normal.dot(map.up)) < kVerticalCosine;
  return spot;
}

Spot resolve(const PlacingWorld& world, const PointPlace& place, const std::string& /*where*/) {
  const bool given = place.normal.norm() > 0.5;
  return free_spot(world.map, place.position, given ? place.normal : world.map.up);
}

Spot resolve(const PlacingWorld& world, const MarkerPlace& place, const std::string& where) {
  const FoundMarker& marker = select_marker(world.markers, place.marker, where);
  const PlaneRecord* plane = find_plane(world.map.planes, marker.plane_id);
  Spot spot = plane != nullptr
                  ? spot_on(world.map, *plane, marker.centre(), mean_camera_position(world.map))
                  : free_spot(world.map, marker.centre(), marker.normal());
  spot.x_axis = tangent(marker.x_axis(), spot.normal).value_or(spot.x_axis);
  return spot;
}

/// Stacked objects take their pose from the one below; see place_object().
Spot resolve(const PlacingWorld& /*world*/, const ObjectPlace& place, const std::string& where) {
  throw UserError(where + ": there is no object '" + place.object + "' to stand on");
}

/// Axes of an object that stands: columns x, y = normal, z = front.
Eigen::Matrix3d standing_axes(const Spot& spot, Face face) {
  Eigen::Vector3d front = spot.x_axis.cross(spot.normal);
  if (face == Face::kCamera) front = tangent(spot.viewer - spot.point, spot.normal).value_or(front);
  Eigen::Matrix3d axes;
  axes << spot.normal.cross(front), spot.normal, front;
  return axes;
}

/// Axes of an object that hangs: z = normal, y as near to up as the wall allows.
Eigen::Matrix3d hanging_axes(const Spot& spot, const Eigen::Vector3d& up) {
  const Eigen::Vector3d y = tangent(up, spot.normal).value_or(spot.normal.cross(spot.x_axis));
  Eigen::Matrix3d axes;
  axes << y.cross(spot.normal), y, spot.normal;
  return axes;
}

double model_scale(const SceneObject& object, const ModelBox& box, const SizeUnit& unit) {
  const double longest = box.sizes().maxCoeff();
  if (!(longest > 0.0) || !std::isfinite(longest)) {
    throw UserError(object.where + ": model '" + object.model.string() + "' has no extent");
  }
  if (object.size) return *object.size * length_unit(object, unit) / longest;
  if (unit.units_per_metre > 0.0) return unit.units_per_metre;
  return kDefaultSize * unit.median_depth / longest;
}

slam::Pose world_from_spot(const Reconstruction& map, const Spot& spot, const SceneObject& object) {
  slam::Pose pose = slam::Pose::Identity();
  pose.translation() = spot.point;
  pose.linear() = Eigen::AngleAxisd(object.yaw_deg * std::numbers::pi / 180.0, spot.normal) *
                  (spot.vertical ? hanging_axes(spot, map.up) : standing_axes(spot, object.face));
  return pose;
}

/// On top of another object, turned by the yaw about their common axis.
Anchor anchor_above(const PlacedObject& below, const SceneObject& object) {
  Anchor anchor = below.anchor;
  anchor.plane_from_anchor.translate(below.hangs ? Eigen::Vector3d(0.0, 0.0, below.sides.z())
                                                 : Eigen::Vector3d(0.0, below.sides.y(), 0.0));
  anchor.plane_from_anchor.rotate(
      Eigen::AngleAxisd(object.yaw_deg * std::numbers::pi / 180.0,
                        below.hangs ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY()));
  return anchor;
}

const PlaneRecord* largest(const Reconstruction& reconstruction,
                           const std::vector<std::string>& classes) {
  const PlaneRecord* best = nullptr;
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (std::ranges::find(classes, plane.plane_class) == classes.end()) continue;
    if (best == nullptr || plane.area > best->area) best = &plane;
  }
  return best;
}

const PlaneRecord* nearest(const Reconstruction& reconstruction) {
  const Eigen::Vector3d viewer = mean_camera_position(reconstruction);
  const PlaneRecord* best = nullptr;
  double best_distance = 0.0;
  for (const PlaneRecord& plane : reconstruction.planes) {
    if (plane.polygon.empty()) continue;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& corner : plane.polygon) centre += corner;
    centre /= static_cast<double>(plane.polygon.size());
    const double distance = (centre - viewer).norm();
    if (best != nullptr && distance >= best_distance) continue;
    best = &plane;
    best_distance = distance;
  }
  return best;
}

}  // namespace

std::optional<slam::Pose> Anchor::world_from_anchor(const std::vector<PlaneRecord>& planes) const {
  if (plane_id == slam::kNone) return plane_from_anchor;
  const PlaneRecord* plane = find_plane(planes, plane_id);
  if (plane == nullptr) return std::nullopt;
  return plane->world_from_plane() * plane_from_anchor;
}

Anchor move_anchor(const Anchor& anchor, const PlaneRecord& from, const PlaneRecord& to) {
  return {to.id,
          to.world_from_plane().inverse() * from.world_from_plane() * anchor.plane_from_anchor};
}

std::optional<Eigen::Affine3d> PlacedObject::world_from_model(
    const std::vector<PlaneRecord>& planes) const {
  if (anchor.plane_id == slam::kNone) return world_from_model(slam::Pose::Identity());
  const PlaneRecord* plane = find_plane(planes, anchor.plane_id);
  if (plane == nullptr) return std::nullopt;
  return world_from_model(plane->world_from_plane());
}

Eigen::Affine3d PlacedObject::world_from_model(const slam::Pose& world_from_plane) const {
  return Eigen::Affine3d(world_from_plane * anchor.plane_from_anchor) * Eigen::Scaling(scale) *
         Eigen::Translation3d(-contact);
}

bool is_vertical(const Reconstruction& reconstruction, const PlaneRecord& plane) {
  if (plane.plane_class == "wall" || plane.plane_class == "vertical") return true;
  if (plane.plane_class != "other") return false;
  return reconstruction.up_confidence > kUsableUp &&
         std::abs(plane.normal.dot(reconstruction.up)) < kVerticalCosine;
}

Eigen::Vector3d mean_camera_position(const Reconstruction& reconstruction) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (!frame.world_from_cam) continue;
    sum += frame.world_from_cam->translation();
    ++count;
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : sum;
}

const PlaneRecord& select_plane(const Reconstruction& reconstruction, const std::string& rule,
                                const std::string& where) {
  const PlaneRecord* plane = nullptr;
  if (rule == "largest-horizontal") {
    plane = largest(reconstruction, {"floor", "horizontal"});
  } else if (rule == "largest-vertical") {
    plane = largest(reconstruction, {"wall", "vertical"});
  } else if (rule == "floor") {
    plane = largest(reconstruction, {"floor"});
  } else if (rule == "nearest") {
    plane = nearest(reconstruction);
  } else {
    plane = find_plane(reconstruction.planes, std::stoi(rule));
  }
  if (plane != nullptr) return *plane;
  throw UserError(where + ": there is no plane '" + rule +
                  "'; planes: " + list_planes(reconstruction.planes));
}

const FoundMarker& select_marker(const MarkerMap& markers, const MarkerId& marker,
                                 const std::string& where) {
  const auto found = markers.find(marker);
  if (found != markers.end()) return found->second;
  throw UserError(where + ": marker " + std::to_string(marker.id) + " of " + marker.dictionary +
                  " was not found in the pictures");
}

PlacedObject place_object(const PlacingWorld& world, const SceneObject& object, const ModelBox& box,
                          const SizeUnit& unit, const PlacedObject* below) {
  PlacedObject placed;
  placed.scale = model_scale(object, box, unit);
  placed.sides = placed.scale * box.sizes();
  if (below != nullptr) {
    placed.hangs = below->hangs;
    placed.tap = below->tap;
    placed.anchor = anchor_above(*below, object);
  } else {
    const Spot spot = std::visit(
        [&](const auto& place) { return resolve(world, place, object.where); }, object.place);
    placed.hangs = spot.vertical;
    placed.tap = spot.tap;
    const slam::Pose world_from_anchor = world_from_spot(world.map, spot, object);
    placed.anchor.plane_id = spot.plane ? spot.plane->id : slam::kNone;
    placed.anchor.plane_from_anchor =
        spot.plane ? spot.plane->world_from_plane().inverse() * world_from_anchor
                   : world_from_anchor;
  }
  const Eigen::Vector3d centre = box.center();
  placed.contact = placed.hangs ? Eigen::Vector3d(centre.x(), centre.y(), box.min().z())
                                : Eigen::Vector3d(centre.x(), box.min().y(), centre.z());
  if (object.offset != Eigen::Vector3d::Zero()) {
    placed.anchor.plane_from_anchor.translate(object.offset * length_unit(object, unit));
  }
  return placed;
}

}  // namespace planecast::engine
