#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "slam/geometry/sim3.h"

namespace planecast::engine {

/// The polygon of a plane in the plane's own 2D frame, for areas, overlaps and grids. A plane
/// without a polygon makes an empty patch: area 0, contains nothing.
class Patch {
 public:
  explicit Patch(const PlaneRecord& plane);

  double area() const { return area_; }
  const Eigen::Vector3d& centroid() const { return centroid_; }  ///< of the area, world
  /// Whether the foot of a world point lies in the polygon, outside its holes.
  bool contains(const Eigen::Vector3d& point) const;
  /// World points at the cell centres of a `cells` x `cells` grid over the bounding rectangle that
  /// lie in the polygon, row by row.
  std::vector<Eigen::Vector3d> grid(int cells) const;

 private:
  using Ring = std::vector<Eigen::Vector2d>;

  Ring flatten(const std::vector<Eigen::Vector3d>& ring) const;
  bool contains_flat(const Eigen::Vector2d& point) const;

  slam::Pose world_from_plane_;
  slam::Pose plane_from_world_;
  std::vector<Ring> rings_;  ///< outer, then holes
  double area_ = 0.0;
  Eigen::Vector3d centroid_;
};

/// The plane seen in another world.
PlaneRecord transformed(const slam::Similarity& target_from_source, PlaneRecord plane);

}  // namespace planecast::engine
