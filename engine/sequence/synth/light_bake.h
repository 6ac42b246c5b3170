#pragma once

#include <vector>

#include "engine/sequence/synth/ray_caster.h"
#include "engine/sequence/synth/room_model.h"

namespace planecast::engine::synth {

/// What arrives on a patch, divided by pi, on a regular grid over it: colour leaving = reflectance
/// x this.
struct LightMap {
  int width = 0;
  int height = 0;
  std::vector<Color> values;

  Color at(float u, float v) const;  ///< bilinear; u, v in [0, 1]
};

/// Rays for each place of the grid. What is small or bent shows noise less.
struct BakeRays {
  int ambient;
  int window;
  int lamp;
};

struct BakeOptions {
  BakeRays flat = {32, 9, 4};
  BakeRays small = {14, 4, 2};
  float detail = 1.0F;  ///< of the grid; 1 is right for pictures 640 wide
};

/// Ambient light with occlusion and one tinted bounce, windows as area lights, lamps, and the sun
/// through the windows' panes, all with soft shadows.
LightMap bake_light(const RoomModel& model, const std::vector<Color>& mean_colors,
                    const RayCaster& rays, int patch_index, const BakeOptions& options);

/// Mean of a patch's texture.
Color mean_color(const Patch& patch);

}  // namespace planecast::engine::synth
