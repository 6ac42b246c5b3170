#include "engine/output/ear_clip.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace planecast::engine {
namespace {

/// Twice the signed area of the triangle a, b, c.
double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Clips one polygon whose outline may touch itself along bridges. `loop_` holds vertex indices,
/// counter-clockwise.
class EarClipper {
 public:
  EarClipper(const std::vector<Eigen::Vector2d>& vertices, std::vector<int> outer)
      : vertices_(vertices), loop_(std::move(outer)) {}

  /// `hole` is clockwise.
  void join_hole(const std::vector<int>& hole) {
    const auto rightmost = std::max_element(hole.begin(), hole.end(), [this](int a, int b) {
      return vertices_[static_cast<std::size_t>(a)].x() <
             vertices_[static_cast<std::size_t>(b)].x();
    });
    std::vector<int> detour(rightmost, hole.end());
    detour.insert(detour.end(), hole.begin(), rightmost);
    const std::size_t bridge = visible_from(*rightmost);
    detour.push_back(*rightmost);
    detour.push_back(loop_[bridge]);
    loop_.insert(loop_.begin() + static_cast<std::ptrdiff_t>(bridge) + 1, detour.begin(),
                 detour.end());
  }

  std::vector<std::array<int, 3>> clip() {
    std::vector<std::array<int, 3>> triangles;
    while (loop_.size() > 3) {
      const std::size_t ear = find_ear();
      if (ear == loop_.size()) return triangles;
      add_if_upright(corner(ear), triangles);
      loop_.erase(loop_.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    if (loop_.size() == 3) add_if_upright({loop_[0], loop_[1], loop_[2]}, triangles);
    return triangles;
  }

 private:
  const Eigen::Vector2d& at(int vertex) const {
    return vertices_[static_cast<std::size_t>(vertex)];
  }

  void add_if_upright(const std::array<int, 3>& triangle,
                      std::vector<std::array<int, 3>>& triangles) const {
    if (cross(at(triangle[0]), at(triangle[1]), at(triangle[2])) > 0.0)
      triangles.push_back(triangle);
  }

  std::array<int, 3> corner(std::size_t i) const {
    const std::size_t n = loop_.size();
    return {loop_[(i + n - 1) % n], loop_[i], loop_[(i + 1) % n]};
  }

  /// A vertex of the loop inside the triangle (or, if they count, on its edges) blocks an ear. A
  /// vertex that coincides with a corner (a bridge's end) does not.
  bool is_blocked(const std::array<int, 3>& triangle, bool edges_count) const {
    const auto [a, b, c] = std::array{at(triangle[0]), at(triangle[1]), at(triangle[2])};
    for (const int vertex : loop_) {
      const Eigen::Vector2d& p = at(vertex);
      if (p == a || p == b || p == c) continue;
      const double depth = std::min({cross(a, b, p), cross(b, c, p), cross(c, a, p)});
      if (depth > 0.0 || (edges_count && depth == 0.0)) return true;
    }
    return false;
  }

  /// Position in the loop; its size when there is none. Flat corners go first: they would never
  /// become ears and only block others.
  std::size_t find_ear() const {
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const std::array<int, 3> triangle = corner(i);
      if (cross(at(triangle[0]), at(triangle[1]), at(triangle[2])) == 0.0) return i;
    }
    // Where outlines touch, only ears with a vertex on their edge may be left.
    for (const bool edges_count : {true, false}) {
      for (std::size_t i = 0; i < loop_.size(); ++i) {
        const std::array<int, 3> triangle = corner(i);
        const bool convex = cross(at(triangle[0]), at(triangle[1]), at(triangle[2])) > 0.0;
        if (convex && !is_blocked(triangle, edges_count)) return i;
      }
    }
    return loop_.size();
  }

  /// Position in the loop of a vertex that the hole's vertex sees: the first edge to its right is
  /// hit by a horizontal ray; the edge's right end is taken unless reflex vertices stand in
  /// between, of which the one nearest in direction to the ray is.
  std::size_t visible_from(int hole_vertex) const {
    const Eigen::Vector2d from = at(hole_vertex);
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const std::size_t j = (i + 1) % loop_.size();
      const Eigen::Vector2d& a = at(loop_[i]);
      const Eigen::Vector2d& b = at(loop_[j]);
      // Seen from inside, an edge to the right runs upwards.
      if (!(a.y() <= from.y() && from.y() < b.y())) continue;
      const double x = a.x() + (from.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (x < from.x() || x >= nearest) continue;
      nearest = x;
      best = a.x() > b.x() ? i : j;
    }
    return std::isinf(nearest) ? 0 : nearest_reflex(from, {nearest, from.y()}, best);
  }

  std::size_t nearest_reflex(const Eigen::Vector2d& from, const Eigen::Vector2d& hit,
                             std::size_t best) const {
    const Eigen::Vector2d candidate = at(loop_[best]);
    const double turn = cross(from, hit, candidate) >= 0.0 ? 1.0 : -1.0;
    double flattest = slope(from, candidate);
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const Eigen::Vector2d& p = at(loop_[i]);
      if (p.x() <= from.x() || p == candidate) continue;
      const bool inside = turn * cross(from, hit, p) >= 0.0 &&
                          turn * cross(hit, candidate, p) >= 0.0 &&
                          turn * cross(candidate, from, p) >= 0.0;
      if (inside && slope(from, p) < flattest) {
        flattest = slope(from, p);
        best = i;
      }
    }
    return best;
  }

  static double slope(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const double run = to.x() - from.x();
    return run > 0.0 ? std::abs(to.y() - from.y()) / run : std::numeric_limits<double>::infinity();
  }

  const std::vector<Eigen::Vector2d>& vertices_;
  std::vector<int> loop_;
};

std::vector<int> append_ring(const Ring2d& ring, bool counter_clockwise,
                             std::vector<Eigen::Vector2d>& vertices) {
  std::vector<int> indices(ring.size());
  std::iota(indices.begin(), indices.end(), static_cast<int>(vertices.size()));
  if ((doubled_area(ring) > 0.0) != counter_clockwise) std::reverse(indices.begin(), indices.end());
  vertices.insert(vertices.end(), ring.begin(), ring.end());
  return indices;
}

}  // namespace

double doubled_area(const Ring2d& ring) {
  double sum = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    sum += a.x() * b.y() - b.x() * a.y();
  }
  return sum;
}

Triangulation triangulate_polygon(const Ring2d& outer, const std::vector<Ring2d>& holes) {
  Triangulation result;
  if (outer.size() < 3) return result;
  const std::vector<int> outline = append_ring(outer, true, result.vertices);
  std::vector<std::vector<int>> hole_loops;
  for (const Ring2d& hole : holes) {
    if (hole.size() >= 3) hole_loops.push_back(append_ring(hole, false, result.vertices));
  }
  // Rightmost holes first: the bridge of a hole may then end on one already joined.
  const auto right_end = [&result](const std::vector<int>& loop) {
    double x = -std::numeric_limits<double>::infinity();
    for (const int i : loop) x = std::max(x, result.vertices[static_cast<std::size_t>(i)].x());
    return x;
  };
  std::stable_sort(hole_loops.begin(), hole_loops.end(),
                   [&](const auto& a, const auto& b) { return right_end(a) > right_end(b); });
  EarClipper clipper(result.vertices, outline);
  for (const std::vector<int>& hole : hole_loops) clipper.join_hole(hole);
  result.triangles = clipper.clip();
  return result;
}

}  // namespace planecast::engine
