#pragma once

#include <glm/glm.hpp>

namespace planecast::render {

/// The part of a vertex that deformation changes.
struct ShapeVertex {
  glm::vec3 position{};
  glm::vec3 normal{};
  glm::vec4 tangent{};  ///< w = handedness of the bitangent; 0 where nothing needs a tangent
};

/// The part that stays.
struct SurfaceVertex {
  glm::vec2 uv0{};
  glm::vec2 uv1{};
  glm::vec4 color = glm::vec4(1.0F);  ///< linear
};

/// Axis-aligned, in whatever frame the name says.
struct Box {
  glm::vec3 min{};
  glm::vec3 max{};
};

}  // namespace planecast::render
