#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/passes/pass_clock.h"
#include "render/passes/targets.h"
#include "render/scene.h"
#include "render/software/object_surface.h"
#include "render/software/plane_shadow.h"
#include "render/software/sample_grid.h"
#include "render/software/software_input.h"
#include "render/software/visible_triangles.h"

namespace planecast::render {

/// Draws layers by the processor itself, four samples a pixel: the same picture as through OpenGL,
/// several times faster than the software rasteriser behind that, and the same bytes on every
/// processor. Knows what drawable_by_processor() does.
class SoftwareLayer {
 public:
  void draw(const SoftwareInput& input, const Window& window, PassClock& clock, Layer& layer);

 private:
  void draw_occluders(const SoftwareInput& input, const Window& window, SampleGrid& grid) const;
  void draw_shadows(const SoftwareInput& input, const Window& window);
  void draw_shadow_row(PlaneShadow& shadow, const DepthPlane& depth, const Window& window,
                       const SampleGrid::Area& area, int y);
  void find_fragments();
  void add_fragment(int x, int y, std::int32_t triangle, unsigned samples);
  void write_colors(const Window& window, Layer& layer) const;
  static void write_mean(std::span<const Fragment> fragments, std::uint32_t shadow,
                         std::uint8_t* rgba);
  void write_depth(const SoftwareInput& input, const Window& window, Layer& layer) const;

  VisibleTriangles visible_;
  std::vector<Fragment> fragments_;
  SampleGrid samples_{SampleGrid::Pattern::kFourSamples};
  SampleGrid centres_{SampleGrid::Pattern::kPixelCentres};
  std::vector<std::uint32_t> shadow_alpha_;  ///< of the four samples of a pixel, a byte each
};

}  // namespace planecast::render
