#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/gltf/model.h"
#include "render/software/mip_texture.h"
#include "render/software/sample_grid.h"

namespace planecast::render {

/// A vertex in the world, with what is interpolated between vertices.
struct WorldVertex {
  glm::vec3 position{};
  float u0 = 0.0F;
  glm::vec3 normal{};
  float v0 = 0.0F;
  glm::vec4 tangent{};
  glm::vec4 color = glm::vec4(1.0F);
  glm::vec2 uv1{};
  glm::vec2 unused{};
};

/// A material's texture and which coordinates it is read by.
struct SurfaceMap {
  const MipTexture* texture = nullptr;
  TextureSlot slot;

  bool read_as(const SurfaceMap& other) const {
    return texture == other.texture && slot.uv_set == other.slot.uv_set &&
           slot.transform == other.slot.transform;
  }
};

/// One primitive of one instance, ready to be shaded.
struct ObjectSurface {
  const WorldVertex* vertices = nullptr;
  const ScreenVertex* screen = nullptr;
  const Material* material = nullptr;
  bool unlit = false;
  bool encoded_color = false;  ///< the base colour's texels are filtered as they are stored
  bool colored = false;        ///< the vertices have colours other than white
  SurfaceMap base_color, metallic_roughness, normal, occlusion, emissive;

  /// Whether any map is read by the second set of coordinates.
  bool second_set() const {
    return (base_color.slot.uv_set | metallic_roughness.slot.uv_set | normal.slot.uv_set |
            occlusion.slot.uv_set | emissive.slot.uv_set) != 0;
  }
};

/// A triangle that may be seen.
struct ObjectTriangle {
  std::array<std::uint32_t, 3> corners{};  ///< vertices of its surface
  std::uint16_t surface = 0;
  bool front = true;
};

/// Some samples of a pixel that show one triangle.
struct Fragment {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::int32_t triangle = 0;            ///< index
  std::uint8_t samples = 0;             ///< one bit each
  std::array<std::uint8_t, 3> color{};  ///< shaded, sRGB, premultiplied
  std::uint8_t alpha = 255;             ///< what a depth image leaves of it
};

}  // namespace planecast::render
