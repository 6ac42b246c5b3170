#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "render/software/lanes.h"
#include "render/software/surface_lanes.h"

// Vectors of space in loops over lanes: plain arithmetic without branches or calls, so that the
// compiler puts neighbouring lanes side by side.
namespace planecast::render {

/// Smoother surfaces would glint in less than a pixel; as model.frag.
inline constexpr float kSmallestRoughness = 0.045F;

struct Vec {
  float x, y, z;
};
PLANECAST_INLINE Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
PLANECAST_INLINE Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PLANECAST_INLINE Vec operator*(Vec a, float s) { return {a.x * s, a.y * s, a.z * s}; }
PLANECAST_INLINE Vec operator*(Vec a, Vec b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
PLANECAST_INLINE float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PLANECAST_INLINE Vec cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PLANECAST_INLINE Vec normalized(Vec a) { return a * (1.0F / std::sqrt(larger(dot(a, a), 1e-30F))); }
PLANECAST_INLINE Vec vec(const glm::vec3& v) { return {v.x, v.y, v.z}; }
PLANECAST_INLINE Vec load(const LaneVec3& lanes, std::size_t i) {
  return {lanes.x[i], lanes.y[i], lanes.z[i]};
}
PLANECAST_INLINE void store(LaneVec3& lanes, std::size_t i, Vec v) {
  lanes.x[i] = v.x;
  lanes.y[i] = v.y;
  lanes.z[i] = v.z;
}

}  // namespace planecast::render
