#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>

#include "render/gltf/model.h"
#include "render/renderer.h"

namespace planecast::render::test {

inline RendererOptions renderer_options(ContextKind kind = ContextKind::kOsMesa) {
  RendererOptions options;
  options.context = kind;
  options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
  return options;
}

/// Folder of recorded data; empty where this machine has none.
inline std::filesystem::path data_folder() {
  const char* given = std::getenv("PLANECAST_DATA");
  const std::filesystem::path folder =
      given != nullptr ? std::filesystem::path(given)
                       : std::filesystem::path(PLANECAST_SOURCE_DIR) / ".." / "shared" / "data";
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

inline Sun no_sun() {
  Sun sun;
  sun.radiance = glm::vec3(0.0F);
  return sun;
}

/// IEC 61966-2-1, 0..255 from linear.
inline float encoded(float linear) {
  const float c =
      linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
  return 255.0F * c;
}

template <typename T>
T at(const Image<T>& image, int u, int v, int channel = 0) {
  return image.pixels[static_cast<std::size_t>((v * image.width + u) * image.channels + channel)];
}

/// Parallelogram with corner `corner` and sides `a`, `b`; normal a x b.
inline SurfaceMesh quad(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b,
                        int label = 1) {
  SurfaceMesh mesh;
  mesh.positions = {corner, corner + a, corner + a + b, corner + b};
  mesh.normals.assign(4, glm::normalize(glm::cross(a, b)));
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.label = label;
  return mesh;
}

inline Primitive sphere_primitive(float radius, int rings = 48) {
  Primitive sphere;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j <= 2 * rings; ++j) {
      const float polar = 3.14159265F * static_cast<float>(i) / static_cast<float>(rings);
      const float around = 3.14159265F * static_cast<float>(j) / static_cast<float>(rings);
      const glm::vec3 n(std::sin(polar) * std::cos(around), std::cos(polar),
                        -std::sin(polar) * std::sin(around));
      sphere.shape.push_back({radius * n, n, {}});
      sphere.surface.emplace_back();
    }
  }
  const auto index = [rings](int i, int j) {
    return static_cast<std::uint32_t>(i * (2 * rings + 1) + j);
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      sphere.indices.insert(sphere.indices.end(),
                            {index(i, j), index(i + 1, j), index(i, j + 1), index(i, j + 1),
                             index(i + 1, j), index(i + 1, j + 1)});
    }
  }
  sphere.box = {glm::vec3(-radius), glm::vec3(radius)};
  return sphere;
}

/// Box around the origin with the given half sides.
inline Primitive box_primitive(const glm::vec3& half) {
  Primitive box;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      glm::vec3 normal(0.0F);
      glm::vec3 a(0.0F);
      normal[axis] = side;
      a[(axis + 1) % 3] = 1.0F;
      const glm::vec3 b = glm::cross(normal, a);
      const auto first = static_cast<std::uint32_t>(box.shape.size());
      for (const glm::vec2 corner :
           {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        box.shape.push_back({half * (normal + corner.x * a + corner.y * b), normal, {}});
        box.surface.emplace_back();
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) box.indices.push_back(first + i);
    }
  }
  box.box = {-half, half};
  return box;
}

inline std::shared_ptr<Model> one_primitive_model(Primitive primitive, const Material& material) {
  auto model = std::make_shared<Model>();
  model->materials = {material};
  primitive.material = 0;
  model->meshes.resize(1);
  model->meshes[0].primitives.push_back(std::move(primitive));
  model->nodes.resize(1);
  model->nodes[0].mesh = 0;
  model->order = {0};
  return model;
}

inline Material matte(const glm::vec3& albedo) {
  Material material;
  material.base_color = glm::vec4(albedo, 1.0F);
  material.metallic = 0.0F;
  return material;
}

}  // namespace planecast::render::test
