#include "engine/sequence/synth/ray_caster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3f;

constexpr int kDeepest = 62;  // of the tree; what is left then is one leaf

struct Bounds {
  Vector3f low = Vector3f::Constant(std::numeric_limits<float>::max());
  Vector3f high = Vector3f::Constant(std::numeric_limits<float>::lowest());

  void add(const Vector3f& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  void add(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  float half_area() const {
    const Vector3f size = high - low;
    return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
  }
};

/// Entry distance into the box, or infinity.
float enter_box(const Eigen::Array4f& low, const Eigen::Array4f& high, const Eigen::Array4f& origin,
                const Eigen::Array4f& inverse, float reach) {
  const Eigen::Array4f a = (low - origin) * inverse;
  const Eigen::Array4f b = (high - origin) * inverse;
  // The fourth lane holds 0 on both sides; it stands for the ray's own beginning.
  const float near = a.min(b).maxCoeff();
  const Eigen::Array4f ends = a.max(b);
  const float far = std::min({ends[0], ends[1], ends[2], reach});
  return near <= far ? near : std::numeric_limits<float>::infinity();
}

Eigen::Array4f widened(const Vector3f& v) { return {v.x(), v.y(), v.z(), 0.0F}; }

}  // namespace

Vector3f RayCaster::Triangle::low() const {
  return corner.cwiseMin(corner + edge_a).cwiseMin(corner + edge_b);
}

Vector3f RayCaster::Triangle::high() const {
  return corner.cwiseMax(corner + edge_a).cwiseMax(corner + edge_b);
}

Vector3f RayCaster::Triangle::middle() const { return 0.5F * (low() + high()); }

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
  nodes_.reserve(2 * triangles_.size());
  nodes_.emplace_back();
  struct Open {
    int node, first, count, depth;
  };
  std::vector<Open> open = {{0, 0, static_cast<int>(triangles_.size()), 0}};
  while (!open.empty()) {
    const auto [node, first, count, depth] = open.back();
    open.pop_back();
    Node leaf;
    const int left = split(first, count, leaf);
    nodes_[static_cast<std::size_t>(node)] = leaf;
    if (left == 0 || depth == kDeepest) continue;
    const int child = static_cast<int>(nodes_.size());
    nodes_[static_cast<std::size_t>(node)].first = child;
    nodes_[static_cast<std::size_t>(node)].count = 0;
    nodes_.emplace_back();
    nodes_.emplace_back();
    open.push_back({child, first, left, depth + 1});
    open.push_back({child + 1, first + left, count - left, depth + 1});
  }
}

/// Fills `node` as a leaf and, where it pays, sorts its triangles into two parts: the number of
/// those in the first, or 0. The split is the cheapest by the surface area heuristic over bins of
/// the widest axis (Wald 2007).
int RayCaster::split(int first, int count, Node& node) {
  Bounds whole;
  Bounds middles;
  for (int i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[static_cast<std::size_t>(i)];
    whole.add(t.low());
    whole.add(t.high());
    middles.add(t.middle());
  }
  node.low = widened(whole.low);
  node.high = widened(whole.high);
  node.first = first;
  node.count = count;
  if (count <= 2) return 0;
  int axis = 0;
  const float extent = (middles.high - middles.low).maxCoeff(&axis);
  if (extent <= 0.0F) return 0;

  constexpr int kBins = 16;
  std::array<Bounds, kBins> box;
  std::array<int, kBins> members{};
  const auto bin_of = [&](const Triangle& t) {
    const float share = (t.middle()[axis] - middles.low[axis]) / extent;
    return std::clamp(static_cast<int>(share * kBins), 0, kBins - 1);
  };
  for (int i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[static_cast<std::size_t>(i)];
    const auto bin = static_cast<std::size_t>(bin_of(t));
    box[bin].add(t.low());
    box[bin].add(t.high());
    ++members[bin];
  }
  float best_cost = whole.half_area() * static_cast<float>(count);
  int best = -1;
  for (int cut = 0; cut + 1 < kBins; ++cut) {
    Bounds low;
    Bounds high;
    int below = 0;
    for (int bin = 0; bin < kBins; ++bin) {
      const auto at = static_cast<std::size_t>(bin);
      if (members[at] == 0) continue;
      (bin <= cut ? low : high).add(box[at]);
      if (bin <= cut) below += members[at];
    }
    if (below == 0 || below == count) continue;
    const float cost = low.half_area() * static_cast<float>(below) +
                       high.half_area() * static_cast<float>(count - below);
    if (cost < best_cost) {
      best_cost = cost;
      best = cut;
    }
  }
  if (best < 0) return 0;
  const auto begin = triangles_.begin() + first;
  const auto middle = std::stable_partition(begin, begin + count,
                                            [&](const Triangle& t) { return bin_of(t) <= best; });
  return static_cast<int>(middle - begin);
}

template <bool any_hit>
RayHit RayCaster::trace(const Vector3f& origin, const Vector3f& direction, float reach) const {
  RayHit hit{reach, -1};
  if (nodes_.empty()) return hit;
  const Vector3f inverse3 = direction.unaryExpr(
      [](float x) { return 1.0F / (std::abs(x) < 1e-9F ? std::copysign(1e-9F, x) : x); });
  const Eigen::Array4f inverse = widened(inverse3);
  const Eigen::Array4f origin4 = widened(origin);
  const auto enter = [&](int index) {
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    return enter_box(node.low, node.high, origin4, inverse, hit.distance);
  };
  std::array<std::pair<float, int>, kDeepest + 2> stack;
  std::size_t depth = 0;
  if (const float at = enter(0); !std::isinf(at)) stack[depth++] = {at, 0};
  while (depth > 0) {
    const auto [entry, index] = stack[--depth];
    if (entry >= hit.distance) continue;
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.count == 0) {  // the nearer child last, so that it is looked at first
      std::pair<float, int> near = {enter(node.first), node.first};
      std::pair<float, int> far = {enter(node.first + 1), node.first + 1};
      if (far.first < near.first) std::swap(near, far);
      if (!std::isinf(far.first)) stack[depth++] = far;
      if (!std::isinf(near.first)) stack[depth++] = near;
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
