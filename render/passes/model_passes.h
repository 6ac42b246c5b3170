#pragma once

#include <vector>

#include "render/passes/models.h"
#include "render/passes/occluders.h"
#include "render/passes/shadow_map.h"
#include "render/scene.h"

namespace planecast::render {

/// What the shaded pass needs beside the items.
struct ShadingInput {
  const Camera* camera = nullptr;
  const Light* light = nullptr;
  const ShadowMap* shadow = nullptr;  ///< null: nothing is in shadow
  GLuint occluder_depth = 0;          ///< texture of the camera's size, 0: none
  float occluder_tolerance = kOccluderTolerance;
  float exposure = 1.0F;
  ToneMap tone_map = ToneMap::kNone;
  GLuint environment = 0;  ///< cube texture, 0: reflections come from the harmonics
  int environment_levels = 0;
  bool multisampled = true;
  float detail_px = 0.0F;  ///< how far simplified meshes may be off on the screen
};

/// Inverse transpose up to a factor, defined for singular matrices too.
glm::mat3 normal_matrix(const glm::mat4& matrix);

/// How far a simplified item may be off in the world to stay within `pixels` on the screen, at its
/// nearest point.
float allowed_error_m(const DrawItem& item, const Camera& camera, float pixels);

/// Whether the dielectric part reflects as glTF's core says: 4 %, white.
bool plain_reflectance(const Material& material);

/// Draws posed models; one object for the passes they appear in.
class ModelPasses {
 public:
  ModelPasses(const Gl& gl, ShaderLibrary& shaders, const ModelSet& models)
      : gl_(&gl), shaders_(&shaders), models_(&models) {}

  /// Depth alone, seen along `clip_from_world`, into whatever target is bound; meshes may be off by
  /// `error_m`.
  void draw_depth(const std::vector<DrawItem>& items, const glm::mat4& clip_from_world,
                  float error_m) const;
  /// Metallic-roughness shading, premultiplied and encoded: opaque and masked items first, then
  /// blended ones from back to front.
  void draw_color(const std::vector<DrawItem>& items, const ShadingInput& input) const;
  /// Depth in metres and label 0 into a GeometryTarget.
  void draw_geometry(const std::vector<DrawItem>& items, const ShadingInput& input) const;
  /// Highest top and lowest underside above a plane, seen along its normal; see heights.frag.
  void draw_heights(const std::vector<DrawItem>& items, const glm::mat4& clip_from_world,
                    const glm::vec4& plane, float error_m) const;

 private:
  void draw_shaded(const DrawItem& item, const ShadingInput& input) const;
  void set_lit(const DrawItem& item, const Program& program, const ShadingInput& input) const;
  void set_layers(const DrawItem& item, const Program& program) const;
  void set_lamps(const Program& program) const;
  void set_cut_out(const DrawItem& item, const Program& program) const;
  void bind_map(const DrawItem& item, const Program& program, const TextureSlot& slot,
                TextureUse use, unsigned unit, const char* name) const;

  const Gl* gl_;
  ShaderLibrary* shaders_;
  const ModelSet* models_;
};

}  // namespace planecast::render
