#pragma once

#include <cstdint>
#include <vector>

#include "render/passes/models.h"
#include "render/passes/plane_frame.h"
#include "render/passes/targets.h"
#include "render/scene.h"
#include "render/software/baked_shadow.h"
#include "render/software/fragment_shader.h"
#include "render/software/object_surface.h"
#include "render/software/sample_grid.h"

namespace planecast::render {

struct SoftwareInput {
  const LayerScene* scene = nullptr;
  const Camera* camera = nullptr;
  const std::vector<DrawItem>* items = nullptr;
  const std::vector<ShadowOnPlane>* shadows = nullptr;
  LightUniforms light;
  ShadowTexels shadow;
  float detail_px = 0.0F;
};

/// Draws layers by the processor itself, four samples a pixel: the same picture as through OpenGL,
/// several times faster than the software rasteriser behind that, and the same bytes on every
/// processor. Knows the metallic-roughness material with all its maps, opaque; see can_draw().
class SoftwareLayer {
 public:
  /// Whether everything in the picture is of the kinds that are known here. Depends on nothing but
  /// its arguments. `still`: shadows on planes are baked.
  static bool can_draw(const LayerScene& scene, const Camera& camera,
                       const std::vector<DrawItem>& items, bool lamps, bool still);

  void draw(const SoftwareInput& input, const Window& window, Layer& layer);
  void clear();

 private:
  /// Vertices of an item in the world, kept while it stands still.
  struct Posed {
    std::uint64_t signature = 0;
    std::vector<WorldVertex> vertices;
    std::vector<ScreenVertex> screen;
    bool colored = false;
  };

  void pose(const DrawItem& item, Posed& posed) const;
  void project(const Camera& camera, const Window& window, Posed& posed) const;
  void add_surface(const DrawItem& item, const Posed& posed);
  void add_triangles(const DrawItem& item, const SoftwareInput& input, const Window& window,
                     std::uint16_t surface);
  void draw_occluders(const SoftwareInput& input, const Window& window, SampleGrid& grid) const;
  void draw_shadows(const SoftwareInput& input, const Window& window);
  void draw_shadow_row(BakedShadow& shadow, const DepthPlane& depth, const Window& window,
                       const SampleGrid::Area& area, int y);
  void draw_objects(SampleGrid& grid) const;
  void find_fragments();
  void write_colors(const Window& window, Layer& layer) const;
  void write_depth(const SoftwareInput& input, const Window& window, Layer& layer) const;

  std::vector<Posed> posed_;
  std::vector<ObjectSurface> surfaces_;
  std::vector<ObjectTriangle> triangles_;
  std::vector<Fragment> fragments_;
  SampleGrid samples_{SampleGrid::Pattern::kFourSamples};
  SampleGrid centres_{SampleGrid::Pattern::kPixelCentres};
  std::vector<std::uint32_t> shadow_alpha_;  ///< of the four samples of a pixel, a byte each
};

}  // namespace planecast::render
