#include "engine/scene/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/scene/hit_test.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr double kVerticalCosine = 0.7071;  ///< normals farther than 45 degrees from up are walls'
constexpr double kUsableUp = 0.1;           ///< confidence below which the up direction is not used
constexpr double kDefaultSize = 0.25;       ///< of the median depth, for maps without scale

/// What the three kinds of place have in common once resolved.
struct Spot {
  const PlaneRecord* plane = nullptr;  ///< null: a free point of the world
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
  Eigen::Vector3d x_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d viewer = Eigen::Vector3d::Zero();  ///< whom content faces
  bool vertical = false;
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
  spot.plane = &plane;
  spot.point = point;
  spot.normal = plane.normal;
  spot.x_axis = plane.x_axis;
  spot.viewer = viewer;
  spot.vertical = is_vertical(reconstruction, plane);
  return spot;
}

Spot resolve(const Reconstruction& reconstruction, const PixelPlace& place, bool causal,
             const std::string& where) {
  const Hit hit = tap(reconstruction, place.frame, place.pixel, causal, where);
  const PlaneRecord* plane = find_plane(reconstruction.planes, hit.plane_id);
  return spot_on(reconstruction, *plane, hit.point,
                 frame_pose(reconstruction, place.frame, causal, where).translation());
}

Spot resolve(const Reconstruction& reconstruction, const PlanePlace& place, bool /*causal*/,
             const std::string& where) {
  const PlaneRecord& plane = select_plane(reconstruction, place.plane, where);
  const Eigen::AlignedBox2d box = bounding_box(plane_outline(plane));
  if (box.isEmpty()) {
    throw UserError(where + ": plane " + std::to_string(plane.id) + " has no outline to place on");
  }
  const Eigen::Vector2d at = box.min() + place.at.cwiseProduct(box.sizes());
  const Eigen::Vector3d point = plane.world_from_plane() * Eigen::Vector3d(at.x(), at.y(), 0.0);
  return spot_on(reconstruction, plane, point, mean_camera_position(reconstruction));
}

Spot resolve(const Reconstruction& reconstruction, const PointPlace& place, bool /*causal*/,
             const std::string& /*where*/) {
  Spot spot;
  spot.point = place.position;
  spot.normal = place.normal.norm() > 0.5 ? place.normal : reconstruction.up;
  spot.x_axis = tangent(Eigen::Vector3d::UnitX(), spot.normal).value_or(any_tangent(spot.normal));
  spot.viewer = mean_camera_position(reconstruction);
  spot.vertical = reconstruction.up_confidence > kUsableUp &&
                  std::abs(spot.normal.dot(reconstruction.up)) < kVerticalCosine;
  return spot;
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
  if (unit.units_per_metre > 0.0) {
    return object.size ? *object.size * unit.units_per_metre / longest : unit.units_per_metre;
  }
  return object.size.value_or(kDefaultSize) * unit.median_depth / longest;
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
  const std::optional<slam::Pose> world_from_anchor = anchor.world_from_anchor(planes);
  if (!world_from_anchor) return std::nullopt;
  return Eigen::Affine3d(*world_from_anchor) * Eigen::Scaling(scale) *
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

PlacedObject place_object(const Reconstruction& reconstruction, const SceneObject& object,
                          const ModelBox& box, const SizeUnit& unit, bool causal) {
  const Spot spot = std::visit(
      [&](const auto& place) { return resolve(reconstruction, place, causal, object.where); },
      object.place);
  const Eigen::Vector3d centre = box.center();
  PlacedObject placed;
  placed.scale = model_scale(object, box, unit);
  placed.hangs = spot.vertical;
  placed.contact = spot.vertical ? Eigen::Vector3d(centre.x(), centre.y(), box.min().z())
                                 : Eigen::Vector3d(centre.x(), box.min().y(), centre.z());
  slam::Pose world_from_anchor = slam::Pose::Identity();
  world_from_anchor.translation() = spot.point;
  world_from_anchor.linear() =
      Eigen::AngleAxisd(object.yaw_deg * std::numbers::pi / 180.0, spot.normal) *
      (spot.vertical ? hanging_axes(spot, reconstruction.up) : standing_axes(spot, object.face));
  placed.anchor.plane_id = spot.plane != nullptr ? spot.plane->id : slam::kNone;
  placed.anchor.plane_from_anchor =
      spot.plane != nullptr ? spot.plane->world_from_plane().inverse() * world_from_anchor
                            : world_from_anchor;
  return placed;
}

}  // namespace planecast::engine
