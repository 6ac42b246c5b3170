#include "render/software/software_input.h"

#include <algorithm>
#include <cmath>

#include "render/passes/model_passes.h"
#include "render/passes/view.h"

namespace planecast::render {
namespace {

/// Beyond these the snapped coordinates would not be exact.
constexpr float kFarthestPixel = 16000.0F;
constexpr std::size_t kMostSurfaces = 65535;

bool known_material(const Material& material) {
  return material.alpha_mode == AlphaMode::kOpaque && material.transmission == 0.0F &&
         material.clearcoat == 0.0F && material.sheen_color == glm::vec3(0.0F) &&
         plain_reflectance(material);
}

/// In front of the camera with all its corners, and not so near that it is far larger than the
/// picture.
bool well_in_front(const DrawItem& item, const Camera& camera) {
  for (const glm::vec3& corner :
       box_corners(item.box, camera.camera_from_world * item.world_from_shape)) {
    if (!(corner.z > camera.near_plane)) return false;
    const float u = camera.fx * corner.x / corner.z + camera.cx;
    const float v = camera.fy * corner.y / corner.z + camera.cy;
    if (!(std::abs(u) < kFarthestPixel && std::abs(v) < kFarthestPixel)) return false;
  }
  return true;
}

float shadow_radius_m(const Sun& sun, const SunMap& map) {
  return sun.softness * map.projection().texel_m;
}

}  // namespace

bool drawable_by_processor(const LayerScene& scene, const Camera& camera,
                           const std::vector<DrawItem>& items, bool lamps) {
  if (scene.tone_map != ToneMap::kNone || lamps || items.size() > kMostSurfaces) return false;
  return std::ranges::all_of(items, [&](const DrawItem& item) {
    return item.mode == GL_TRIANGLES && known_material(*item.material) &&
           well_in_front(item, camera);
  });
}

LightUniforms light_uniforms(const LayerScene& scene, const Camera& camera, const SunMap* sun) {
  LightUniforms light;
  light.eye = camera_position(camera);
  light.ambient_sh = scene.light.ambient_sh;
  light.to_light = glm::normalize(scene.light.sun.direction_to_light);
  light.sun = scene.light.sun.radiance;
  light.exposure = scene.exposure;
  if (sun == nullptr) return light;
  const ShadowProjection& projection = sun->projection();
  light.shadow_from_world = projection.clip_from_world;
  light.shadow_reach_m = 1.5F * projection.texel_m + shadow_radius_m(scene.light.sun, *sun);
  light.shadow_bias = 0.5F * projection.texel_m / projection.depth_m;
  return light;
}

ShadowTexels shadow_texels(const Sun& sun, const SunMap* map) {
  if (map == nullptr) return {};
  return {map->depths(), map->size(),
          glm::vec2(0.9F, 0.35F) * (shadow_radius_m(sun, *map) / map->projection().extent_m)};
}

DepthOcclusion depth_occlusion(const LayerScene& scene, const Camera& camera, float tolerance) {
  const ImageF* depth = scene.occluder_depth;
  if (depth == nullptr || depth->width != camera.width || depth->height != camera.height) return {};
  return {depth, tolerance};
}

}  // namespace planecast::render
