#include "render/passes/plane_frame.h"

#include <algorithm>
#include <cmath>

namespace planecast::render {
namespace {

struct Edge {
  glm::vec2 from{};
  glm::vec2 to{};
};

std::vector<Edge> all_edges(const PlanePatch& patch, const PlaneFrame& frame) {
  std::vector<Edge> edges;
  const auto add_ring = [&](const std::vector<glm::vec3>& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      edges.push_back({frame.coordinates(ring[i]), frame.coordinates(ring[(i + 1) % ring.size()])});
    }
  };
  add_ring(patch.outer);
  for (const auto& hole : patch.holes) add_ring(hole);
  return edges;
}

/// The cells of one row: their places along x, and what the edges met so far say of them.
struct CellRow {
  std::vector<float> x;
  std::vector<float> nearest2;  ///< squared distance
  std::vector<int> inside;      ///< odd number of crossings

  explicit CellRow(int cells)
      : x(static_cast<std::size_t>(cells)), nearest2(x.size()), inside(x.size()) {}
  void begin(float reach_m) {
    std::ranges::fill(nearest2, reach_m * reach_m);
    std::ranges::fill(inside, 0);
  }
  void add_distance(const Edge& edge, float y);
  void add_crossings(const Edge& edge, float y);
};

/// Cells innermost and without branches, so that the compiler takes several at once.
void CellRow::add_distance(const Edge& edge, float y) {
  const glm::vec2 along = edge.to - edge.from;
  const float length2 = glm::dot(along, along);
  const float divisor = length2 > 0.0F ? length2 : 1.0F;
  const float up = y - edge.from.y;
  const float across = length2 > 0.0F ? up * along.y : 0.0F;
  const float slope = length2 > 0.0F ? along.x : 0.0F;
  const float left = edge.from.x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float right = x[i] - left;
    const float t = std::clamp((right * slope + across) / divisor, 0.0F, 1.0F);
    const float off_x = right - t * along.x;
    const float off_y = up - t * along.y;
    nearest2[i] = std::min(nearest2[i], off_x * off_x + off_y * off_y);
  }
}

/// A ray to the right crosses the edge.
void CellRow::add_crossings(const Edge& edge, float y) {
  if ((edge.from.y > y) == (edge.to.y > y)) return;
  const float t = (y - edge.from.y) / (edge.to.y - edge.from.y);
  const float crossing = edge.from.x + t * (edge.to.x - edge.from.x);
  for (std::size_t i = 0; i < x.size(); ++i) inside[i] ^= x[i] < crossing ? 1 : 0;
}

}  // namespace

PlaneRegion intersection(const PlaneRegion& a, const PlaneRegion& b) {
  return {glm::max(a.min, b.min), glm::min(a.max, b.max)};
}

PlaneRegion nothing() {
  constexpr float kLargest = std::numeric_limits<float>::max();
  return {glm::vec2(kLargest), glm::vec2(-kLargest)};
}

glm::vec2 PlaneFrame::coordinates(const glm::vec3& world) const {
  return {glm::dot(x, world - origin), glm::dot(y, world - origin)};
}

float PlaneFrame::height(const glm::vec3& world) const { return glm::dot(normal, world - origin); }

std::vector<glm::vec3> PlaneFrame::corners(const PlaneRegion& region) const {
  return {world(region.min), world({region.max.x, region.min.y}), world(region.max),
          world({region.min.x, region.max.y})};
}

bool drawable(const PlanePatch& patch) {
  const float length = glm::length(patch.normal);
  return patch.outer.size() >= 3 && std::isfinite(length) && length > 1e-6F;
}

PlaneFrame plane_frame(const PlanePatch& patch) {
  PlaneFrame frame;
  frame.normal = glm::normalize(patch.normal);
  glm::dvec3 sum(0.0);
  for (const glm::vec3& point : patch.outer) sum += glm::dvec3(point);
  frame.origin = glm::vec3(sum / static_cast<double>(patch.outer.size()));
  const glm::vec3 helper =
      std::abs(frame.normal.x) < 0.9F ? glm::vec3(1.0F, 0.0F, 0.0F) : glm::vec3(0.0F, 1.0F, 0.0F);
  frame.y = glm::normalize(glm::cross(frame.normal, helper));
  frame.x = glm::cross(frame.y, frame.normal);
  return frame;
}

PlaneRegion outer_region(const PlanePatch& patch, const PlaneFrame& frame) {
  PlaneRegion region = nothing();
  for (const glm::vec3& point : patch.outer) region.add(frame.coordinates(point));
  return region;
}

ImageF distance_to_edge(const PlanePatch& patch, const PlaneFrame& frame, const PlaneRegion& region,
                        int longest_side, float reach_m) {
  const glm::vec2 size = region.size();
  const float cell = std::max(size.x, size.y) / static_cast<float>(longest_side);
  const auto cells = [&](float side) {
    return std::clamp(static_cast<int>(std::ceil(side / cell)), 1, longest_side);
  };
  ImageF distance(cells(size.x), cells(size.y), 1);
  const std::vector<Edge> edges = all_edges(patch, frame);
  CellRow cells_of_row(distance.width);
  for (std::size_t i = 0; i < cells_of_row.x.size(); ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(distance.width);
    cells_of_row.x[i] = region.min.x + share * size.x;
  }
  std::size_t next = 0;
  for (int row = 0; row < distance.height; ++row) {
    const float share = (static_cast<float>(row) + 0.5F) / static_cast<float>(distance.height);
    const float y = region.min.y + share * size.y;
    cells_of_row.begin(reach_m);
    for (const Edge& edge : edges) {
      const auto [low, high] = std::minmax(edge.from.y, edge.to.y);
      if (y >= low - reach_m && y <= high + reach_m) cells_of_row.add_distance(edge, y);
      cells_of_row.add_crossings(edge, y);
    }
    for (std::size_t i = 0; i < cells_of_row.x.size(); ++i) {
      const float away = std::sqrt(cells_of_row.nearest2[i]);
      distance.pixels[next++] = cells_of_row.inside[i] != 0 ? away : -away;
    }
  }
  return distance;
}

}  // namespace planecast::render
