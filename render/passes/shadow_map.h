#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/gl/objects.h"
#include "render/gl/program.h"
#include "render/scene.h"

namespace planecast::render {

/// Parallel projection along the sun, fitted to what casts shadows.
struct ShadowProjection {
  glm::mat4 clip_from_world = glm::mat4(1.0F);  ///< depth 0 nearest to the sun .. 1
  float texel_m = 0.0F;                         ///< side of a texel on a facing plane
  float extent_m = 0.0F;                        ///< side of the map
  float depth_m = 0.0F;                         ///< its depth range
};

/// `points` are corners of the casters' boxes in the world. The map keeps `margin_texels` of free
/// border, so that filters find light there. An empty set gives a unit box.
ShadowProjection fit_shadow(const glm::vec3& direction_to_light, std::span<const glm::vec3> points,
                            int size, float margin_texels);

/// Depth map of the casters, square, read by comparison (soft) or raw (to find how far the blocker
/// is).
class ShadowMap {
 public:
  ShadowMap(const Gl& gl, int size);

  /// Binds for drawing with casters of `projection` and clears. Draw with front-to-back depth LESS.
  void begin(const ShadowProjection& projection);
  /// Binds the two samplers and sets what shadow.glsl reads.
  void bind(const Program& program, const Sun& sun) const;
  const ShadowProjection& projection() const { return projection_; }
  /// The depths in memory, rows of size() values.
  std::vector<float> read() const;
  int size() const { return size_; }

 private:
  const Gl* gl_;
  int size_;
  TextureHandle depth_;
  FramebufferHandle framebuffer_;
  SamplerHandle compare_;
  SamplerHandle raw_;
  ShadowProjection projection_;
};

}  // namespace planecast::render
