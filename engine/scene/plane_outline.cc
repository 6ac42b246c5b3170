#include "engine/scene/plane_outline.h"

#include <algorithm>
#include <limits>

namespace planecast::engine {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

bool ring_contains(const Ring& ring, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

double distance_to_ring(const Ring& ring, const Eigen::Vector2d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Eigen::Vector2d edge = ring[i] - ring[j];
    const double length2 = edge.squaredNorm();
    const double t = length2 > 0.0 ? std::clamp((p - ring[j]).dot(edge) / length2, 0.0, 1.0) : 0.0;
    best = std::min(best, (ring[j] + t * edge - p).norm());
  }
  return best;
}

Ring flatten(const slam::Pose& plane_from_world, const std::vector<Eigen::Vector3d>& ring) {
  Ring flat;
  flat.reserve(ring.size());
  for (const Eigen::Vector3d& corner : ring) flat.push_back((plane_from_world * corner).head<2>());
  return flat;
}

}  // namespace

PlaneOutline plane_outline(const PlaneRecord& plane) {
  const slam::Pose plane_from_world = plane.world_from_plane().inverse();
  PlaneOutline outline;
  outline.outer = flatten(plane_from_world, plane.polygon);
  for (const auto& hole : plane.holes) outline.holes.push_back(flatten(plane_from_world, hole));
  return outline;
}

bool contains(const PlaneOutline& outline, const Eigen::Vector2d& point) {
  if (outline.outer.size() < 3 || !ring_contains(outline.outer, point)) return false;
  return std::ranges::none_of(outline.holes, [&point](const Ring& hole) {
    return hole.size() >= 3 && ring_contains(hole, point);
  });
}

double distance_to_edge(const PlaneOutline& outline, const Eigen::Vector2d& point) {
  double best = distance_to_ring(outline.outer, point);
  for (const Ring& hole : outline.holes) best = std::min(best, distance_to_ring(hole, point));
  return best;
}

Eigen::AlignedBox2d bounding_box(const PlaneOutline& outline) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : outline.outer) box.extend(corner);
  return box;
}

const PlaneRecord* find_plane(const std::vector<PlaneRecord>& planes, int id) {
  for (const PlaneRecord& plane : planes) {
    if (plane.id == id) return &plane;
  }
  for (const PlaneRecord& plane : planes) {
    if (std::ranges::find(plane.merged_from, id) != plane.merged_from.end()) return &plane;
  }
  return nullptr;
}

std::string list_planes(const std::vector<PlaneRecord>& planes) {
  constexpr std::size_t kMost = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(planes.size(), kMost); ++i) {
    if (i > 0) text += ", ";
    text += std::to_string(planes[i].id) + " (" + planes[i].plane_class + ")";
  }
  if (planes.size() > kMost) text += ", ...";
  return text.empty() ? "none" : text;
}

}  // namespace planecast::engine
