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

/// Least-squares plane through the (weighted) centroid along the scatter's smallest singular
/// direction; the normal's sign is arbitrary. Nothing for fewer than 3 points or where they lie on
/// a line.
std::optional<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points);
/// The same over `indices`, each with weight w_i (of its squared distance); `weights` may be empty.
std::optional<PlaneFit> fit_plane(const std::vector<Eigen::Vector3d>& points,
                                  const std::vector<int>& indices,
                                  const std::vector<double>& weights);

/// Distance along the ray where it meets the plane, in units of `direction`'s length; nothing
/// behind the origin or where the ray runs along the plane (|cos| < 1e-9).
std::optional<double> intersect_ray(const PlaneEquation& plane, const Eigen::Vector3d& origin,
                                    const Eigen::Vector3d& direction);

/// Area of a ring (not closed), positive if it is counter-clockwise.
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

/// Distance within which points of one plane count as connected: twice their typical spacing, at
/// which evenly strewn points hang together and far strays do not. 0 for fewer than 4 points.
double linking_distance(const std::vector<Eigen::Vector3d>& points);

/// Concave outline of points near a plane. `spacing` is the distance of neighbouring points (<= 0:
/// it is measured). Of the largest cluster of points an occupancy grid in the plane's frame with
/// cells of spacing / 4 is closed over gaps up to the linking distance and padded by 0.3 spacing;
/// the largest patch's contours, simplified to a cell, are the extent. Empty for fewer than 3
/// points.
PlaneExtent plane_extent(const Plane& plane, const std::vector<Eigen::Vector3d>& points,
                         double spacing);

}  // namespace planecast::slam
