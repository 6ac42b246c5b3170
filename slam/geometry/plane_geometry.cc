#include "slam/geometry/plane_geometry.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "slam/geometry/point_clusters.h"

namespace planecast::slam {

namespace {

/// Spread of the second direction relative to the first below which points count as being on a
/// line.
constexpr double kMinSpread = 1e-6;

bool crosses_upward_ray(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                        const Eigen::Vector2d& p) {
  if ((a.y() > p.y()) == (b.y() > p.y())) return false;
  return p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y());
}

bool is_inside_ring(const std::vector<Eigen::Vector2d>& ring, const Eigen::Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    if (crosses_upward_ray(ring[i], ring[j], point)) inside = !inside;
  }
  return inside;
}

}  // namespace

std::optional<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points,
                                  const std::vector<int>& indices,
                                  const std::vector<double>& weights) {
  if (indices.size() < 3) return std::nullopt;
  const auto weight = [&](int i) { return weights.empty() ? 1.0 : weights[i]; };
  double total = 0.0;
  PlaneFit fit;
  for (const int i : indices) {
    fit.centroid += weight(i) * points[i];
    total += weight(i);
  }
  fit.centroid /= total;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const int i : indices) {
    const Eigen::Vector3d step = points[i] - fit.centroid;
    scatter += weight(i) * step * step.transpose();
  }
  // Its eigenvectors are the right singular vectors of the centred points.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  if (!(solver.eigenvalues()[1] > kMinSpread * solver.eigenvalues()[2])) return std::nullopt;
  fit.plane.normal = solver.eigenvectors().col(0).normalized();
  fit.plane.offset = -fit.plane.normal.dot(fit.centroid);
  fit.rms = std::sqrt(std::max(solver.eigenvalues()[0], 0.0) / total);
  return fit;
}

std::optional<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points) {
  std::vector<int> all(points.size());
  std::iota(all.begin(), all.end(), 0);
  return fit_plane(points, all, {});
}

std::optional<double> intersect_ray(const PlaneEquation& plane, const Eigen::Vector3d& origin,
                                    const Eigen::Vector3d& direction) {
  const double along = plane.normal.dot(direction);
  if (std::abs(along) < 1e-9 * direction.norm()) return std::nullopt;
  const double distance = -plane.signed_distance(origin) / along;
  if (!(distance >= 0.0)) return std::nullopt;
  return distance;
}

double signed_area(const std::vector<Eigen::Vector2d>& ring) {
  double doubled = 0.0;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    doubled += ring[j].x() * ring[i].y() - ring[i].x() * ring[j].y();
  }
  return 0.5 * doubled;
}

bool contains_point(const std::vector<Eigen::Vector2d>& outer,
                    const std::vector<std::vector<Eigen::Vector2d>>& holes,
                    const Eigen::Vector2d& point) {
  if (outer.empty() || !is_inside_ring(outer, point)) return false;
  return std::none_of(holes.begin(), holes.end(), [&](const auto& hole) {
    return !hole.empty() && is_inside_ring(hole, point);
  });
}

double linking_distance(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kLinkPerSpacing = 2.0;
  return kLinkPerSpacing * typical_spacing(points);
}

}  // namespace planecast::slam
