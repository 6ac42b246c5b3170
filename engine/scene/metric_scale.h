#pragma once

#include "engine/scene/scene_file.h"

namespace planecast::engine {

struct PlacingWorld;

/// What a scene file's `size` counts in.
struct SizeUnit {
  double units_per_metre = 0.0;  ///< 0: the map has no scale
  double median_depth = 1.0;     ///< map units; the unit of sizes when there is no scale
};

/// Unit for one object: metres where the reconstruction or the scene's `scale` has them; else the
/// median depth of the finished map (causal, for a tap: of what the tapped frame sees). Throws
/// UserError when the scale's pixels, planes or marker are not there.
SizeUnit size_unit(const PlacingWorld& world, const SceneFile& scene, const SceneObject& object);

}  // namespace planecast::engine
