#pragma once

#include <vector>

#include "render/passes/models.h"
#include "render/passes/shadow_map.h"
#include "render/software/coverage.h"
#include "render/software/posed_meshes.h"

namespace planecast::render {

/// The sun's shadow map drawn by the processor: what ShadowMap holds after ModelPasses::draw_depth,
/// of opaque triangles.
class SunMap {
 public:
  explicit SunMap(int size);

  /// Meshes may be off by `detail_texels`. Items that are no triangles cast nothing.
  void draw(const ShadowProjection& projection, const std::vector<DrawItem>& items,
            const PosedMeshes& meshes, float detail_texels);
  const ShadowProjection& projection() const { return projection_; }
  /// Rows of size() values, 0 nearest to the sun, 1 where nothing is.
  const float* depths() const { return reinterpret_cast<const float*>(blocks_.data()); }
  int size() const { return size_; }

 private:
  void draw_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c);

  int size_;
  ShadowProjection projection_;
  std::vector<F4> blocks_;  ///< four texels of a row each
  std::vector<ScreenVertex> screen_;
};

}  // namespace planecast::render
