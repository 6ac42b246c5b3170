#pragma once

#include <cstdint>
#include <vector>

#include "render/passes/models.h"
#include "render/passes/pass_clock.h"
#include "render/scene.h"
#include "render/software/posed_meshes.h"
#include "render/software/software_catchers.h"
#include "render/software/software_layer.h"
#include "render/software/sun_map.h"

namespace planecast::render {

/// The items of a frame and what is known of them.
struct PosedItems {
  const std::vector<DrawItem>* items = nullptr;
  const std::vector<glm::vec3>* points = nullptr;  ///< corners of their boxes, world
  std::uint64_t signature = 0;  ///< changes when the items or the sun do; see caster_signature()
  bool still = false;           ///< none ever moves
};

/// Draws whole layers by the processor: the sun's shadow map, the shadows on planes and the
/// objects. Keeps what stands still from frame to frame.
class SoftwarePainter {
 public:
  /// `detail_px`: how far simplified meshes may be off, on the screen and in the maps.
  SoftwarePainter(int shadow_map_size, float detail_px);

  /// `layer` has its images, empty. Call when drawable_by_processor() says so.
  void draw(const LayerScene& scene, const Camera& camera, const PosedItems& posed,
            PassClock& clock, Layer& layer);
  void clear();

 private:
  const SunMap* update_sun(const Sun& sun, const PosedItems& posed);

  float detail_px_;
  PosedMeshes meshes_;
  SunMap sun_;
  std::uint64_t sun_signature_ = 0;
  SoftwareCatchers catchers_;
  EnvironmentInMemory environment_;
  SoftwareLayer layer_;
};

}  // namespace planecast::render
