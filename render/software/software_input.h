#pragma once

#include <vector>

#include "render/passes/models.h"
#include "render/scene.h"
#include "render/software/fragment_shader.h"
#include "render/software/plane_shadow.h"
#include "render/software/posed_meshes.h"
#include "render/software/sun_map.h"

namespace planecast::render {

/// What SoftwareLayer draws from.
struct SoftwareInput {
  const LayerScene* scene = nullptr;
  const Camera* camera = nullptr;
  const std::vector<DrawItem>* items = nullptr;
  const PosedMeshes* meshes = nullptr;
  const std::vector<ShadowOnPlane>* shadows = nullptr;
  ShadingUniforms shading;
  DepthOcclusion plane_occlusion;  ///< of the shadows
  float detail_px = 0.0F;          ///< how far simplified meshes may be off on the screen
};

/// Whether everything in the picture is of the kinds that the processor draws: opaque triangles of
/// metallic-roughness materials, well in front of the camera, lit by the surroundings and the sun.
/// Depends on nothing but its arguments.
bool drawable_by_processor(const LayerScene& scene, const Camera& camera,
                           const std::vector<DrawItem>& items, bool lamps);

/// The scene's light on its objects. `sun` null: nothing is in shadow.
LightUniforms light_uniforms(const LayerScene& scene, const Camera& camera, const SunMap* sun);
ShadowTexels shadow_texels(const Sun& sun, const SunMap* map);

/// The scene's depth image, if it is of the camera's size.
DepthOcclusion depth_occlusion(const LayerScene& scene, const Camera& camera, float tolerance);

}  // namespace planecast::render
