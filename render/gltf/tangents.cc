#include "render/gltf/tangents.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace planecast::render {
namespace {

template <typename T>
void gather(std::vector<T>& stream, const std::vector<std::uint32_t>& source) {
  if (stream.empty()) return;
  std::vector<T> gathered(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) gathered[i] = stream[source[i]];
  stream = std::move(gathered);
}

/// The direction of +u on a triangle, and -1 where the texture lies mirrored on it.
struct TriangleTangent {
  glm::vec3 direction{};
  float handedness = 1.0F;
  bool valid = false;
};

TriangleTangent triangle_tangent(const Primitive& primitive, const std::uint32_t* corner,
                                 int uv_set) {
  const auto uv = [&](int i) {
    const SurfaceVertex& vertex = primitive.surface[corner[i]];
    return uv_set == 0 ? vertex.uv0 : vertex.uv1;
  };
  const glm::vec3 origin = primitive.shape[corner[0]].position;
  const glm::vec3 edge1 = primitive.shape[corner[1]].position - origin;
  const glm::vec3 edge2 = primitive.shape[corner[2]].position - origin;
  const glm::vec2 uv1 = uv(1) - uv(0);
  const glm::vec2 uv2 = uv(2) - uv(0);
  const float area = uv1.x * uv2.y - uv1.y * uv2.x;
  const glm::vec3 direction = (edge1 * uv2.y - edge2 * uv1.y) * (area < 0.0F ? -1.0F : 1.0F);
  TriangleTangent tangent;
  tangent.valid = area != 0.0F && glm::length(direction) > 0.0F && std::isfinite(area);
  if (tangent.valid) tangent.direction = glm::normalize(direction);
  // cross(normal, tangent) * w is the normal map's "up", against glTF's v, which runs down the
  // image: on an unmirrored front (u, v) turns against the winding.
  tangent.handedness = area < 0.0F ? 1.0F : -1.0F;
  return tangent;
}

float corner_angle(const Primitive& primitive, const std::uint32_t* corner, int i) {
  const glm::vec3 at = primitive.shape[corner[i]].position;
  const glm::vec3 a = primitive.shape[corner[(i + 1) % 3]].position - at;
  const glm::vec3 b = primitive.shape[corner[(i + 2) % 3]].position - at;
  const float lengths = glm::length(a) * glm::length(b);
  return lengths > 0.0F ? std::acos(std::clamp(glm::dot(a, b) / lengths, -1.0F, 1.0F)) : 0.0F;
}

/// Any unit vector at right angles to `normal`.
glm::vec3 some_tangent(const glm::vec3& normal) {
  const glm::vec3 helper = std::abs(normal.x) < 0.9F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  return glm::normalize(glm::cross(helper, normal));
}

}  // namespace

void gather_vertices(Primitive& primitive, const std::vector<std::uint32_t>& source) {
  gather(primitive.shape, source);
  gather(primitive.surface, source);
  gather(primitive.joints, source);
  gather(primitive.joint_weights, source);
  for (MorphTarget& target : primitive.targets) {
    gather(target.positions, source);
    gather(target.normals, source);
    gather(target.tangents, source);
  }
}

void set_flat_normals(std::vector<ShapeVertex>& shape) {
  for (std::size_t i = 0; i + 2 < shape.size(); i += 3) {
    ShapeVertex* corner = &shape[i];
    const glm::vec3 across = glm::cross(corner[1].position - corner[0].position,
                                        corner[2].position - corner[0].position);
    const float area = glm::length(across);
    for (int k = 0; k < 3; ++k) {
      corner[k].normal = area > 0.0F ? across / area : glm::vec3(0.0F, 0.0F, 1.0F);
    }
  }
}

void add_flat_normals(Primitive& primitive) {
  gather_vertices(primitive, primitive.indices);
  for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
    primitive.indices[i] = static_cast<std::uint32_t>(i);
  }
  set_flat_normals(primitive.shape);
  primitive.flat_normals = true;
  for (MorphTarget& target : primitive.targets) target.normals.clear();
}

void add_tangents(Primitive& primitive, int uv_set) {
  // Vertex and handedness -> new vertex; the first handedness met keeps the vertex's place.
  std::vector<std::uint32_t> source(primitive.shape.size());
  for (std::size_t i = 0; i < source.size(); ++i) source[i] = static_cast<std::uint32_t>(i);
  std::vector<float> handedness(source.size(), 0.0F);
  std::vector<glm::vec3> sums(source.size(), glm::vec3(0.0F));
  std::map<std::uint32_t, std::uint32_t> mirrored;

  for (std::size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
    const std::array<std::uint32_t, 3> corner = {primitive.indices[t], primitive.indices[t + 1],
                                                 primitive.indices[t + 2]};
    const TriangleTangent tangent = triangle_tangent(primitive, corner.data(), uv_set);
    if (!tangent.valid) continue;
    for (int i = 0; i < 3; ++i) {
      std::uint32_t vertex = corner[static_cast<std::size_t>(i)];
      if (handedness[vertex] == -tangent.handedness) {
        const auto [place, is_new] =
            mirrored.emplace(vertex, static_cast<std::uint32_t>(source.size()));
        if (is_new) {
          source.push_back(vertex);
          handedness.push_back(tangent.handedness);
          sums.emplace_back(0.0F);
        }
        vertex = place->second;
        primitive.indices[t + static_cast<std::size_t>(i)] = vertex;
      }
      handedness[vertex] = tangent.handedness;
      sums[vertex] += tangent.direction * corner_angle(primitive, corner.data(), i);
    }
  }

  gather_vertices(primitive, source);
  for (std::size_t i = 0; i < source.size(); ++i) {
    ShapeVertex& vertex = primitive.shape[i];
    const glm::vec3 flat = sums[i] - vertex.normal * glm::dot(vertex.normal, sums[i]);
    const float length = glm::length(flat);
    const glm::vec3 direction = length > 1e-6F ? flat / length : some_tangent(vertex.normal);
    vertex.tangent = glm::vec4(direction, handedness[i] < 0.0F ? -1.0F : 1.0F);
  }
}

}  // namespace planecast::render
