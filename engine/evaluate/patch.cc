#include "engine/evaluate/patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace planecast::engine {
namespace {

struct AreaMoments {
  double area = 0.0;  ///< absolute
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
};

AreaMoments moments_of(const std::vector<Eigen::Vector2d>& ring) {
  double doubled = 0.0;
  Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    const double cross = a.x() * b.y() - b.x() * a.y();
    doubled += cross;
    weighted += cross * (a + b);
  }
  if (std::abs(doubled) < 1e-15) return {};
  return {std::abs(doubled) / 2.0, weighted / (3.0 * doubled)};
}

bool is_inside(const std::vector<Eigen::Vector2d>& ring, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

}  // namespace

Patch::Patch(const PlaneRecord& plane)
    : world_from_plane_(plane.world_from_plane()),
      plane_from_world_(world_from_plane_.inverse()),
      centroid_(plane.origin) {
  if (plane.polygon.size() < 3) return;
  rings_.push_back(flatten(plane.polygon));
  const AreaMoments outer = moments_of(rings_[0]);
  area_ = outer.area;
  Eigen::Vector2d weighted = outer.area * outer.centroid;
  for (const auto& hole : plane.holes) {
    if (hole.size() < 3) continue;
    rings_.push_back(flatten(hole));
    const AreaMoments inner = moments_of(rings_.back());
    area_ -= inner.area;
    weighted -= inner.area * inner.centroid;
  }
  area_ = std::max(area_, 0.0);
  if (area_ > 0.0) {
    const Eigen::Vector2d flat = weighted / area_;
    centroid_ = world_from_plane_ * Eigen::Vector3d(flat.x(), flat.y(), 0.0);
  }
}

Patch::Ring Patch::flatten(const std::vector<Eigen::Vector3d>& ring) const {
  Ring flat;
  for (const Eigen::Vector3d& vertex : ring) flat.push_back((plane_from_world_ * vertex).head<2>());
  return flat;
}

bool Patch::contains_flat(const Eigen::Vector2d& point) const {
  if (rings_.empty() || !is_inside(rings_[0], point)) return false;
  return std::none_of(rings_.begin() + 1, rings_.end(),
                      [&point](const Ring& hole) { return is_inside(hole, point); });
}

bool Patch::contains(const Eigen::Vector3d& point) const {
  return contains_flat((plane_from_world_ * point).head<2>());
}

std::vector<Eigen::Vector3d> Patch::grid(int cells) const {
  std::vector<Eigen::Vector3d> points;
  if (rings_.empty()) return points;
  Eigen::Vector2d low = rings_[0][0];
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& vertex : rings_[0]) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const Eigen::Vector2d cell = (high - low) / cells;
  for (int row = 0; row < cells; ++row) {
    for (int col = 0; col < cells; ++col) {
      const Eigen::Vector2d flat = low + cell.cwiseProduct(Eigen::Vector2d(col + 0.5, row + 0.5));
      if (!contains_flat(flat)) continue;
      points.emplace_back(world_from_plane_ * Eigen::Vector3d(flat.x(), flat.y(), 0.0));
    }
  }
  return points;
}

PlaneRecord transformed(const slam::Similarity& target_from_source, PlaneRecord plane) {
  const double scale = target_from_source.scale;
  plane.normal = target_from_source.rotation * plane.normal;
  plane.offset = scale * plane.offset - plane.normal.dot(target_from_source.translation);
  plane.origin = target_from_source * plane.origin;
  plane.x_axis = target_from_source.rotation * plane.x_axis;
  plane.rms *= scale;
  plane.area *= scale * scale;
  for (Eigen::Vector3d& vertex : plane.polygon) vertex = target_from_source * vertex;
  for (auto& hole : plane.holes) {
    for (Eigen::Vector3d& vertex : hole) vertex = target_from_source * vertex;
  }
  return plane;
}

}  // namespace planecast::engine
