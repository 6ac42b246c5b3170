#include "render/software/posed_meshes.h"

#include <cmath>

#include "render/passes/content_hash.h"
#include "render/passes/model_passes.h"

namespace planecast::render {
namespace {

std::uint64_t signature_of(const DrawItem& item) {
  ContentHash hash;
  hash.add(item.gpu->serial);
  hash.add(item.primitive);
  hash.add(item.shape_version);
  hash.add(item.world_from_shape);
  return hash.value();
}

void pose(const DrawItem& item, PosedMesh& posed) {
  const std::vector<ShapeVertex>& shape = *item.shape;
  const std::vector<SurfaceVertex>& surface = item.primitive->surface;
  const glm::mat4& world = item.world_from_shape;
  const glm::mat3 linear(world);
  const glm::mat3 normals = normal_matrix(world);
  posed.colored = false;
  posed.vertices.resize(shape.size());
  for (std::size_t i = 0; i < shape.size(); ++i) {
    WorldVertex& vertex = posed.vertices[i];
    const glm::vec3 normal = normals * shape[i].normal;
    const float length2 = glm::dot(normal, normal);
    vertex.position = glm::vec3(world * glm::vec4(shape[i].position, 1.0F));
    vertex.normal = length2 > 0.0F ? normal / std::sqrt(length2) : normal;
    vertex.tangent = glm::vec4(linear * glm::vec3(shape[i].tangent), shape[i].tangent.w);
    const SurfaceVertex values = i < surface.size() ? surface[i] : SurfaceVertex{};
    vertex.u0 = values.uv0.x;
    vertex.v0 = values.uv0.y;
    vertex.uv1 = values.uv1;
    vertex.color = values.color;
    posed.colored = posed.colored || values.color != glm::vec4(1.0F);
  }
}

}  // namespace

void PosedMeshes::update(const std::vector<DrawItem>& items) {
  meshes_.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::uint64_t signature = signature_of(items[i]);
    if (meshes_[i].signature == signature) continue;
    meshes_[i].signature = signature;
    pose(items[i], meshes_[i]);
  }
}

const std::vector<std::uint32_t>& triangles_of(const DrawItem& item, float error_m) {
  const std::size_t level = item.level(error_m);
  return level == 0 ? item.primitive->indices : item.primitive->details[level - 1].indices;
}

}  // namespace planecast::render
