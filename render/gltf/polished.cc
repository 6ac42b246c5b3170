#include "render/gltf/polished.h"

#include <algorithm>
#include <cmath>

namespace planecast::render {
namespace {

/// Rougher surfaces blur the surroundings to little more than their harmonics.
constexpr float kRoughestMetal = 0.5F;
/// A dielectric reflects a twentieth: only what is really smooth shows anything.
constexpr float kRoughestGlaze = 0.2F;
constexpr float kMetal = 0.5F;
/// Of a primitive.
constexpr double kFairShare = 0.1;

bool polished(float metallic, float roughness) {
  return roughness <= kRoughestGlaze || (metallic >= kMetal && roughness <= kRoughestMetal);
}

/// The texel nearest to a vertex's coordinates, repeated.
const std::uint8_t* texel_at(const ImageU8& image, const TextureSlot& slot,
                             const SurfaceVertex& vertex) {
  const glm::vec2 own = slot.uv_set == 0 ? vertex.uv0 : vertex.uv1;
  const glm::vec2 uv(slot.transform * glm::vec3(own, 1.0F));
  const auto along = [](float share, int size) {
    const float inside = share - std::floor(share);
    return std::clamp(static_cast<int>(inside * static_cast<float>(size)), 0, size - 1);
  };
  const auto at =
      static_cast<std::size_t>(along(uv.y, image.height) * image.width + along(uv.x, image.width));
  return &image.pixels[at * static_cast<std::size_t>(image.channels)];
}

/// Looks at the texels that the mesh uses: what lies between the parts of an atlas is often black,
/// which would be a mirror.
bool polished(const Model& model, const Primitive& primitive) {
  const Material& material = model.materials[static_cast<std::size_t>(primitive.material)];
  if (material.unlit) return false;
  if (material.clearcoat > 0.3F && material.clearcoat_roughness <= kRoughestGlaze) return true;
  const TextureSlot& slot = material.metallic_roughness_map;
  const int index =
      slot.texture < 0 ? -1 : model.textures[static_cast<std::size_t>(slot.texture)].image;
  if (index < 0) return polished(material.metallic, material.roughness);
  const ImageU8& image = model.images[static_cast<std::size_t>(index)];
  if (image.channels < 3 || image.pixels.empty()) return false;
  // A few thousand vertices tell as much as all.
  const std::size_t step = std::max<std::size_t>(1, primitive.surface.size() / 4096);
  std::size_t found = 0;
  std::size_t asked = 0;
  for (std::size_t i = 0; i < primitive.surface.size(); i += step, ++asked) {
    const std::uint8_t* texel = texel_at(image, slot, primitive.surface[i]);
    found += polished(material.metallic * static_cast<float>(texel[2]) / 255.0F,
                      material.roughness * static_cast<float>(texel[1]) / 255.0F)
                 ? 1
                 : 0;
  }
  return static_cast<double>(found) > kFairShare * static_cast<double>(asked);
}

}  // namespace

bool is_polished(const Model& model) {
  return std::ranges::any_of(model.meshes, [&](const Mesh& mesh) {
    return std::ranges::any_of(mesh.primitives, [&](const Primitive& primitive) {
      return primitive.material >= 0 && polished(model, primitive);
    });
  });
}

}  // namespace planecast::render
