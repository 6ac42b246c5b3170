#include "engine/sequence/synth/ray_caster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3f;

constexpr int kLeafTriangles = 4;

/// Entry distance into the box, or infinity.
float enter_box(const Vector3f& low, const Vector3f& high, const Vector3f& origin,
                const Vector3f& inverse, float reach) {
  float near = 0.0F;
  float far = reach;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = (low[axis] - origin[axis]) * inverse[axis];
    const float b = (high[axis] - origin[axis]) * inverse[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far ? near : std::numeric_limits<float>::infinity();
}

}  // namespace

RayCaster::RayCaster(const RoomModel& model) {
  for (std::size_t p = 0; p < model.patches.size(); ++p) {
    const Patch& patch = model.patches[p];
    if (!patch.casts_shadow) continue;
    for (int j = 0; j < patch.rows; ++j) {
      for (int i = 0; i < patch.cols; ++i) {
        const auto at = static_cast<std::size_t>(j * (patch.cols + 1) + i);
        const std::size_t above = at + static_cast<std::size_t>(patch.cols) + 1;
        const Vector3f& a = patch.positions[at];
        const Vector3f& b = patch.positions[at + 1];
        const Vector3f& c = patch.positions[above + 1];
        const Vector3f& d = patch.positions[above];
        triangles_.push_back({a, b - a, c - a, static_cast<int>(p)});
        triangles_.push_back({a, c - a, d - a, static_cast<int>(p)});
      }
    }
  }
  if (triangles_.empty()) return;
  nodes_.reserve(triangles_.size());
  nodes_.emplace_back();
  std::vector<std::array<int, 3>> open = {{0, 0, static_cast<int>(triangles_.size())}};
  while (!open.empty()) {
    const auto [node, first, count] = open.back();
    open.pop_back();
    Vector3f low = Vector3f::Constant(std::numeric_limits<float>::max());
    Vector3f high = -low;
    Vector3f middle_low = low;
    Vector3f middle_high = high;
    for (int i = first; i < first + count; ++i) {
      const Triangle& t = triangles_[static_cast<std::size_t>(i)];
      const Vector3f b = t.corner + t.edge_a;
      const Vector3f c = t.corner + t.edge_b;
      low = low.cwiseMin(t.corner).cwiseMin(b).cwiseMin(c);
      high = high.cwiseMax(t.corner).cwiseMax(b).cwiseMax(c);
      const Vector3f middle = (t.corner + b + c) / 3.0F;
      middle_low = middle_low.cwiseMin(middle);
      middle_high = middle_high.cwiseMax(middle);
    }
    Node& made = nodes_[static_cast<std::size_t>(node)];
    made.low = low;
    made.high = high;
    made.first = first;
    made.count = count;
    if (count <= kLeafTriangles) continue;
    int axis = 0;
    (middle_high - middle_low).maxCoeff(&axis);
    const auto begin = triangles_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [axis](const Triangle& a, const Triangle& b) {
                       return 3.0F * a.corner[axis] + a.edge_a[axis] + a.edge_b[axis] <
                              3.0F * b.corner[axis] + b.edge_a[axis] + b.edge_b[axis];
                     });
    const int child = static_cast<int>(nodes_.size());
    made.first = child;
    made.count = 0;
    nodes_.emplace_back();
    nodes_.emplace_back();
    open.push_back({child, first, count / 2});
    open.push_back({child + 1, first + count / 2, count - count / 2});
  }
}

template <bool any_hit>
RayHit RayCaster::trace(const Vector3f& origin, const Vector3f& direction, float reach) const {
  RayHit hit{reach, -1};
  if (nodes_.empty()) return hit;
  const Vector3f inverse = direction.unaryExpr(
      [](float x) { return 1.0F / (std::abs(x) < 1e-9F ? std::copysign(1e-9F, x) : x); });
  std::array<int, 64> stack;  // the tree halves its triangles: far shallower than this
  int depth = 0;
  stack[static_cast<std::size_t>(depth++)] = 0;
  while (depth > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[static_cast<std::size_t>(--depth)])];
    if (std::isinf(enter_box(node.low, node.high, origin, inverse, hit.distance))) continue;
    if (node.count == 0) {
      stack[static_cast<std::size_t>(depth++)] = node.first;
      stack[static_cast<std::size_t>(depth++)] = node.first + 1;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      // Moeller and Trumbore 1997
      const Triangle& t = triangles_[static_cast<std::size_t>(i)];
      const Vector3f p = direction.cross(t.edge_b);
      const float determinant = t.edge_a.dot(p);
      if (std::abs(determinant) < 1e-12F) continue;
      const float scale = 1.0F / determinant;
      const Vector3f s = origin - t.corner;
      const float u = s.dot(p) * scale;
      if (u < 0.0F || u > 1.0F) continue;
      const Vector3f q = s.cross(t.edge_a);
      const float v = direction.dot(q) * scale;
      if (v < 0.0F || u + v > 1.0F) continue;
      const float distance = t.edge_b.dot(q) * scale;
      if (distance <= 1e-4F || distance >= hit.distance) continue;
      hit = {distance, t.patch};
      if (any_hit) return hit;
    }
  }
  return hit;
}

RayHit RayCaster::nearest(const Vector3f& origin, const Vector3f& direction, float reach) const {
  return trace<false>(origin, direction, reach);
}

bool RayCaster::blocked(const Vector3f& origin, const Vector3f& direction, float reach) const {
  return trace<true>(origin, direction, reach).patch >= 0;
}

}  // namespace planecast::engine::synth
