#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/data/plane.h"

namespace planecast::slam {

/// normal . x + offset = 0 with a unit normal.
struct PlaneEquation {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;

  double signed_distance(const Eigen::Vector3d& point) const { return normal.dot(point) + offset; }
  PlaneEquation flipped() const { return {-normal, -offset}; }
};

struct PlaneFit {
  PlaneEquation plane;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double rms = 0.0;  ///< weighted, of the distances
};

/// Least-squares plane through the (weighted) centroid along the scatter's smallest singular direction; the
/// normal's sign is arbitrary. Nothing for fewer than 3 points or where they lie on a line.
std::optional<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points);
/// The same over `indices`, each with weight w_i (of its squared distance); `weights` may be empty.
std::optional<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points,
                                  const std::vector<int>& indices,
                                  const std::vector<double>& weights);

/// Distance along the ray where it meets the plane, in units of `direction`'s length; nothing behind the
/// origin or where the ray runs along the plane (|cos| < 1e-9).
std::optional<double> intersect_ray(const PlaneEquation& plane, const Eigen::Vector3d& origin,
                                    const Eigen::Vector3d& direction);

/// Twice signed area is positive for counter-clockwise rings; not closed.
double signed_area(const std::vector<Eigen::Vector2d>& ring);
/// Even-odd rule over the outer ring and its holes.
bool contains_point(const std::vector<Eigen::Vector2d>& outer,
                    const std::vector<std::vector<Eigen::Vector2d>>& holes,
                    const Eigen::Vector2d& point);

/// Outline of the part of a plane that is known, in the world and on the plane. The outer ring is
/// counter-clockwise seen from the normal's side, holes clockwise; none is closed.
struct PlaneExtent {
  std::vector<Eigen::Vector3d> outer;
  std::vector<std::vector<Eigen::Vector3d>> holes;
  double area = 0.0;  ///< square map units, without the holes
};

/// Distance at which points of a plane count as neighbours: three times the median distance to the third
/// nearest, so that a few dozen landmarks make one patch and far strays none. 0 for fewer than 4 points.
double linking_distance(const std::vector<Eigen::Vector3d>& points);

/// Concave outline of points near a plane: an occupancy grid in the plane's frame with cells from
/// `spacing` (the distance of neighbouring points; <= 0: measured), closed over twice the spacing, largest
/// connected patch, contours simplified to half a cell. Empty for fewer than 3 points.
PlaneExtent plane_extent(const Plane& plane, const std::vector<Eigen::Vector3d>& points,
                         double spacing);

}  // namespace planecast::slam
