#pragma once

#include <cstdint>
#include <vector>

#include "render/passes/model_passes.h"
#include "render/passes/shadow_map.h"
#include "render/passes/surfaces.h"
#include "render/scene.h"

namespace planecast::render {

/// Casters step back by their slope over so many texels, so that they do not shade themselves
/// between texels.
inline constexpr float kCasterSlopeTexels = 1.5F;

bool casts(const Sun& sun);

/// The shadow map's projection for casters with these box corners.
ShadowProjection fit_sun(const Sun& sun, const std::vector<glm::vec3>& points, int size);

/// What the shadows of a frame depend on, except the planes they fall on.
std::uint64_t caster_signature(const ModelSet& models, const Sun& sun);

/// The sun's shadow map through OpenGL, drawn anew only when casters or sun change.
class SunShadow {
 public:
  /// `size` is rounded down to a power of two. Meshes may be off by `detail_texels`.
  SunShadow(const Gl& gl, int size, float detail_texels);

  struct Casters {
    const std::vector<DrawItem>* items = nullptr;
    const std::vector<glm::vec3>* points = nullptr;  ///< corners of all casters' boxes, world
    const SurfaceSet* surfaces = nullptr;            ///< others beside the items, or null
    std::uint64_t signature = 0;                     ///< changes when the casters or the sun do
  };
  /// Null when the sun throws no shadow.
  const ShadowMap* update(const Sun& sun, const Casters& casters, const ModelPasses& models,
                          ShaderLibrary& shaders);
  void forget() { signature_ = 0; }

 private:
  const Gl* gl_;
  ShadowMap map_;
  float detail_texels_;
  std::uint64_t signature_ = 0;
};

}  // namespace planecast::render
