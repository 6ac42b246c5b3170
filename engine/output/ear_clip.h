#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace planecast::engine {

using Ring2d = std::vector<Eigen::Vector2d>;

/// A triangulated polygon: the vertices are the outer ring's followed by the holes' in order.
struct Triangulation {
  std::vector<Eigen::Vector2d> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise
};

/// Twice the signed area of a ring that is not closed: positive when counter-clockwise.
double doubled_area(const Ring2d& ring);

/// Triangulates a simple polygon with holes by ear clipping (Meisters 1975), each hole first joined
/// to the outside by a bridge from its rightmost vertex (Eberly, "Triangulation by Ear Clipping",
/// section 5). Rings may have either direction. O(n^2). Of a self-intersecting polygon the
/// triangles cover what can be clipped; rings of fewer than 3 vertices are left out.
Triangulation triangulate_polygon(const Ring2d& outer, const std::vector<Ring2d>& holes);

}  // namespace planecast::engine
