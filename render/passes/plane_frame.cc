#include "render/passes/plane_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

float squared_distance(const Edge& edge, const glm::vec2& p) {
  const glm::vec2 along = edge.to - edge.from;
  const float length2 = glm::dot(along, along);
  const float t =
      length2 > 0.0F ? std::clamp(glm::dot(p - edge.from, along) / length2, 0.0F, 1.0F) : 0.0F;
  const glm::vec2 off = p - edge.from - t * along;
  return glm::dot(off, off);
}

bool crosses_ray(const Edge& edge, const glm::vec2& p) {
  if ((edge.from.y > p.y) == (edge.to.y > p.y)) return false;
  const float t = (p.y - edge.from.y) / (edge.to.y - edge.from.y);
  return p.x < edge.from.x + t * (edge.to.x - edge.from.x);
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
                        int longest_side) {
  const glm::vec2 size = region.size();
  const float cell = std::max(size.x, size.y) / static_cast<float>(longest_side);
  const auto cells = [&](float side) {
    return std::clamp(static_cast<int>(std::ceil(side / cell)), 1, longest_side);
  };
  ImageF distance(cells(size.x), cells(size.y), 1);
  const std::vector<Edge> edges = all_edges(patch, frame);
  for (int row = 0; row < distance.height; ++row) {
    for (int column = 0; column < distance.width; ++column) {
      const glm::vec2 share(
          (static_cast<float>(column) + 0.5F) / static_cast<float>(distance.width),
          (static_cast<float>(row) + 0.5F) / static_cast<float>(distance.height));
      const glm::vec2 p = region.min + share * size;
      float nearest2 = std::numeric_limits<float>::max();
      bool inside = false;
      for (const Edge& edge : edges) {
        nearest2 = std::min(nearest2, squared_distance(edge, p));
        inside ^= crosses_ray(edge, p);
      }
      const float away = std::sqrt(nearest2);
      distance.pixels[static_cast<std::size_t>(row * distance.width + column)] =
          inside ? away : -away;
    }
  }
  return distance;
}

}  // namespace planecast::render
