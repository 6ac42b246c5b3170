#pragma once

#include <vector>

#include "render/software/footprints.h"
#include "render/software/object_surface.h"
#include "render/software/surface_lanes.h"

namespace planecast::render {

/// Shades fragments at their pixels' centres, kLanes of one surface at once.
class FragmentShader {
 public:
  FragmentShader(const std::vector<ObjectSurface>& surfaces,
                 const std::vector<ObjectTriangle>& triangles, const LightUniforms& light,
                 const ShadowTexels& shadow);

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

  const std::vector<ObjectSurface>* surfaces_;
  const std::vector<ObjectTriangle>* triangles_;
  const LightUniforms* light_;
  ShadowTexels shadow_;
  std::vector<Fragment*> ordered_;
  std::vector<std::size_t> first_of_surface_;  ///< in `ordered_`, with one beyond the last
  PlaceLanes place_{};
  SurfaceLanes lanes_{};
  std::array<FootprintLanes, 2> points_{};  ///< by set of coordinates
  TextureReads reads_;
};

}  // namespace planecast::render
