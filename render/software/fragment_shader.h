#pragma once

#include <vector>

#include "render/software/depth_occlusion.h"
#include "render/software/environment_lanes.h"
#include "render/software/footprints.h"
#include "render/software/object_surface.h"
#include "render/software/surface_lanes.h"

namespace planecast::render {

/// What all fragments of a picture share.
struct ShadingUniforms {
  LightUniforms light;
  ShadowTexels shadow;
  Reflections reflections;
  DepthOcclusion occlusion;
  glm::ivec2 corner{};     ///< the window's first pixel in the picture
  glm::vec4 view_depth{};  ///< depth along the optical axis = view_depth . (world, 1)
};

/// Shades fragments at their pixels' centres, kLanes of one surface at once.
class FragmentShader {
 public:
  FragmentShader(const std::vector<ObjectSurface>& surfaces,
                 const std::vector<ObjectTriangle>& triangles, const ShadingUniforms& uniforms);

  void shade(std::vector<Fragment>& fragments);

 private:
  /// Fragments of one surface.
  struct Batch {
    const ObjectSurface* surface = nullptr;
    std::array<Fragment*, kLanes> fragments{};
    std::size_t count = 0;
  };

  void order_by_surface(std::vector<Fragment>& fragments);
  void shade(const Batch& batch);
  void place(const Batch& batch);
  void interpolate(const Batch& batch);
  void read_albedo(const Batch& batch);
  void read_maps(const Batch& batch);
  void read(const SurfaceMap& map);
  void finish(const Batch& batch);
  void hide(const Batch& batch);

  const std::vector<ObjectSurface>* surfaces_;
  const std::vector<ObjectTriangle>* triangles_;
  const ShadingUniforms* uniforms_;
  std::vector<Fragment*> ordered_;
  std::vector<std::size_t> first_of_surface_;  ///< in `ordered_`, with one beyond the last
  PlaceLanes place_{};
  SurfaceLanes lanes_{};
  std::array<FootprintLanes, 2> points_{};  ///< by set of coordinates
  TextureReads reads_;
};

}  // namespace planecast::render
