#include "engine/output/report_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "render/gltf/animate.h"

namespace planecast::engine {
namespace {

using render::Material;
using render::Model;
using render::Primitive;

/// The texel nearest to a texture coordinate, repeated over the plane; white without a map.
glm::vec3 map_color(const Model& model, const render::TextureSlot& slot, const glm::vec2& uv) {
  if (slot.texture < 0) return glm::vec3(1.0F);
  const int number = model.textures[static_cast<std::size_t>(slot.texture)].image;
  if (number < 0) return glm::vec3(1.0F);
  const render::ImageU8& image = model.images[static_cast<std::size_t>(number)];
  if (image.empty()) return glm::vec3(1.0F);
  const glm::vec3 moved = slot.transform * glm::vec3(uv, 1.0F);
  const auto texel = [](float at, int side) {
    return std::clamp(static_cast<int>((at - std::floor(at)) * static_cast<float>(side)), 0,
                      side - 1);
  };
  const int pixel = texel(moved.y, image.height) * image.width + texel(moved.x, image.width);
  const auto channel = [&](int c) {
    const int at = pixel * image.channels + std::min(c, image.channels - 1);
    return static_cast<float>(image.pixels[static_cast<std::size_t>(at)]) / 255.0F;
  };
  return {channel(0), channel(1), channel(2)};
}

float encode(float linear) { return std::pow(std::clamp(linear, 0.0F, 1.0F), 1.0F / 2.2F); }

/// sRGB. Factors are linear and the map is encoded; their product encoded is near enough here.
glm::vec3 vertex_color(const Model& model, const Material& material, const Primitive& primitive,
                       std::size_t vertex) {
  glm::vec3 factor(material.base_color);
  glm::vec2 uv(0.0F);
  if (!primitive.surface.empty()) {
    const render::SurfaceVertex& surface = primitive.surface[vertex];
    factor *= glm::vec3(surface.color);
    uv = material.base_color_map.uv_set == 0 ? surface.uv0 : surface.uv1;
  }
  const glm::vec3 encoded(encode(factor.x), encode(factor.y), encode(factor.z));
  return encoded * map_color(model, material.base_color_map, uv);
}

const std::vector<std::uint32_t>& level_of(const Primitive& primitive, std::size_t max_triangles) {
  const std::vector<std::uint32_t>* level = &primitive.indices;
  for (const render::DetailLevel& coarser : primitive.details) {
    if (level->size() / 3 <= max_triangles) break;
    level = &coarser.indices;
  }
  return *level;
}

void add_primitive(const Model& model, const Primitive& primitive, const glm::mat4& place,
                   const std::vector<render::ShapeVertex>& shape, std::size_t max_triangles,
                   ReportMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  const Material& material = model.materials[static_cast<std::size_t>(primitive.material)];
  // Coarse levels leave most vertices unused.
  std::vector<std::int64_t> kept(shape.size(), -1);
  std::uint32_t next = first;
  for (const std::uint32_t index : level_of(primitive, max_triangles)) {
    if (kept[index] < 0) {
      kept[index] = next++;
      const glm::vec3 at = place * glm::vec4(shape[index].position, 1.0F);
      const glm::vec3 color = vertex_color(model, material, primitive, index);
      for (int k = 0; k < 3; ++k) {
        mesh.positions.push_back(at[k]);
        mesh.colors_srgb.push_back(static_cast<std::uint8_t>(std::lround(255.0F * color[k])));
      }
    }
    mesh.triangles.push_back(static_cast<std::uint32_t>(kept[index]));
  }
}

}  // namespace

ReportMesh report_mesh(const Model& model, std::size_t max_triangles) {
  const render::ModelPose pose = render::evaluate_pose(model, -1, 0.0F);
  std::size_t all = 1;
  for (const int number : model.order) {
    const render::Node& node = model.nodes[static_cast<std::size_t>(number)];
    if (node.mesh < 0) continue;
    for (const Primitive& p : model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      all += p.indices.size() / 3;
    }
  }
  ReportMesh mesh;
  for (const int number : model.order) {
    const render::Node& node = model.nodes[static_cast<std::size_t>(number)];
    if (node.mesh < 0) continue;
    const auto at = static_cast<std::size_t>(number);
    std::vector<glm::mat4> joints;
    if (node.skin >= 0) {
      joints = render::joint_matrices(model.skins[static_cast<std::size_t>(node.skin)], pose);
    }
    const glm::mat4 place = joints.empty() ? pose.model_from_node[at] : glm::mat4(1.0F);
    for (const Primitive& p : model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      if (p.topology != render::Topology::kTriangles) continue;
      const std::size_t share = max_triangles * (p.indices.size() / 3) / all;
      const bool moved = render::deforms(p, node);
      add_primitive(model, p, place,
                    moved ? render::deform(p, pose.morph_weights[at], joints) : p.shape, share,
                    mesh);
    }
  }
  if (mesh.triangles.size() / 3 > 2 * max_triangles) return {};
  return mesh;
}

}  // namespace planecast::engine
