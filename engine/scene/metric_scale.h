#pragma once

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/scene_file.h"

namespace planecast::engine {

/// What a scene file's `size` counts in.
struct SizeUnit {
  double units_per_metre = 0.0;  ///< 0: the map has no scale
  double median_depth = 1.0;     ///< map units; the unit of sizes when there is no scale
};

/// Unit for one object: metres where the reconstruction or the scene's `scale` has them; else the
/// median depth of the finished map (causal, for a tap: of what the tapped frame sees). Throws
/// UserError when the scale's pixels or planes are not there.
SizeUnit size_unit(const Reconstruction& reconstruction, const SceneFile& scene,
                   const SceneObject& object, bool causal);

}  // namespace planecast::engine
