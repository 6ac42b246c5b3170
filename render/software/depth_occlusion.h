#pragma once

#include "render/scene.h"
#include "render/software/lanes.h"

namespace planecast::render {

/// What a depth camera saw and what lies behind it: as occluder_depth.glsl.
struct DepthOcclusion {
  const ImageF* depth = nullptr;  ///< null: hides nothing
  float tolerance = 0.0F;         ///< share of the depth over which things vanish
};

/// Shares that are seen of points at kLanes pixels and depths `z` along the optical axis.
void find_visibility(const DepthOcclusion& occlusion, const LaneInt& x, const LaneInt& y,
                     const Lane& z, Lane& visible);

}  // namespace planecast::render
