#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "render/image.h"
#include "render/scene.h"

namespace planecast::render {

/// Rectangle in a plane's coordinates, metres.
struct PlaneRegion {
  glm::vec2 min{};
  glm::vec2 max{};

  bool empty() const { return min.x >= max.x || min.y >= max.y; }
  glm::vec2 size() const { return max - min; }
  void add(const glm::vec2& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
};

PlaneRegion intersection(const PlaneRegion& a, const PlaneRegion& b);
/// A region that holds nothing and takes on what is added.
PlaneRegion nothing();

/// Coordinates on a patch: origin in the mean of the outer ring, z = normal.
struct PlaneFrame {
  glm::vec3 origin{};
  glm::vec3 x{};
  glm::vec3 y{};
  glm::vec3 normal{};

  glm::vec2 coordinates(const glm::vec3& world) const;
  float height(const glm::vec3& world) const;
  glm::vec3 world(const glm::vec2& at) const { return origin + x * at.x + y * at.y; }
  /// normal . p + w = 0
  glm::vec4 equation() const { return {normal, -glm::dot(normal, origin)}; }
  std::vector<glm::vec3> corners(const PlaneRegion& region) const;
};

/// A patch is drawn when it has three points and a normal.
bool drawable(const PlanePatch& patch);
PlaneFrame plane_frame(const PlanePatch& patch);
PlaneRegion outer_region(const PlanePatch& patch, const PlaneFrame& frame);

/// Distance to the nearest edge in metres, positive inside (even-odd over all rings), on a grid
/// over `region` whose cell centres are spread as a texture's texels; at most `longest_side` cells
/// a side. Farther from every edge than `reach_m` the distance need not be found and is said to be
/// that.
ImageF distance_to_edge(const PlanePatch& patch, const PlaneFrame& frame, const PlaneRegion& region,
                        int longest_side, float reach_m = std::numeric_limits<float>::infinity());

}  // namespace planecast::render
