#pragma once

#include <memory>

#include "render/environment.h"
#include "render/gl/objects.h"

namespace planecast::render {

/// The prefiltered surroundings on the GPU, uploaded when they change.
class EnvironmentMap {
 public:
  explicit EnvironmentMap(const Gl& gl) : gl_(&gl) {}

  /// Texture of a cube with one level a roughness.
  GLuint texture(const std::shared_ptr<const Environment>& environment);
  void clear();

 private:
  const Gl* gl_;
  CubeTextureHandle texture_;
  std::shared_ptr<const Environment> uploaded_;
};

}  // namespace planecast::render
