#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

#include "render/scene.h"
#include "render/software/lanes.h"

namespace planecast::render {

struct LaneVec3 {
  Lane x, y, z;
  void set(std::size_t i, const glm::vec3& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
  glm::vec3 get(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// Where pixels lie in their triangles. In: the corners' places from the pixel's centre and their
/// 1/w. Out: perspective-correct weights of the corners and how they change by a pixel to the right
/// and down; the weights of the third corner are what is missing to 1 and 0.
struct alignas(64) PlaceLanes {
  std::array<Lane, 3> u, v, inverse_w;
  std::array<Lane, 2> weight, across, down;
};
void find_weights(PlaceLanes& lanes);

/// A batch of surface points.
struct alignas(64) SurfaceLanes {
  // As interpolated and read from textures.
  LaneVec3 position, normal, tangent;  ///< world; the tangent is 0 where there is no normal map
  Lane handedness;                     ///< of the bitangent
  Lane facing;                         ///< 1 front, -1 back
  LaneVec3 bend;                       ///< normal map's value, -1..1, scaled
  LaneVec3 albedo, emissive;
  Lane metallic, roughness, open;
  Lane arrives;        ///< share of the sun
  LaneVec3 reflected;  ///< what the mirrored eye sees, where it is not left to light()
  // Found by orient().
  LaneVec3 geometric, shading, shadow_at;
  Lane lit;  ///< 1 where the sun can be seen by the shading normal
  // Found by light() or show_albedo(): linear colour, square root taken, 0..1.
  LaneVec3 color_root;
};

/// What a batch shares.
struct LightUniforms {
  glm::vec3 eye{};
  std::array<glm::vec3, 9> ambient_sh{};
  glm::vec3 to_light{};
  glm::vec3 sun{};
  float exposure = 1.0F;
  glm::mat4 shadow_from_world = glm::mat4(1.0F);
  float shadow_reach_m = 0.0F;  ///< how far points step off the surface, see shadow.glsl
  float shadow_bias = 0.0F;
};

/// The sun's shadow map in memory; see shadow.glsl.
struct ShadowTexels {
  const float* depth = nullptr;  ///< null: no shadow
  int size = 0;
  glm::vec2 step{};  ///< from a point to its first tap, in shares of the map
};

/// The normals, and where the point is in the shadow map: as model_maps.glsl and shadow.glsl.
void orient(SurfaceLanes& lanes, const LightUniforms& uniforms);
/// How much of the sun arrives at the places that orient() found in the shadow map.
void find_sun(SurfaceLanes& lanes, const ShadowTexels& shadow);
/// The albedo alone, for unlit materials.
void show_albedo(SurfaceLanes& lanes, float exposure);
/// Metallic-roughness shading: as model.frag without its layers. Reflections come from the
/// harmonics, or from `reflected`.
void light(SurfaceLanes& lanes, const LightUniforms& uniforms);
void light_mirroring(SurfaceLanes& lanes, const LightUniforms& uniforms);

}  // namespace planecast::render
