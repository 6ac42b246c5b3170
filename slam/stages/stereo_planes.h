#pragma once

#include "slam/data/map.h"
#include "slam/stages/plane_by_patches.h"
#include "slam/stages/plane_points.h"
#include "slam/stages/stereo_depth.h"

namespace planecast::slam {

struct StereoPlaneOptions {
  StereoDepthOptions depth;
  PlaneByPatchesOptions patches;
  /// A keyframe is looked at if none before it stands within this share of its median depth and
  /// looks the same way.
  double min_distance = 0.15;
  double min_turn_deg = 12.0;
};

/// [D] The planes of a finished monocular map that hold too few corners to be found by them: depth
/// of pairs of keyframes (stereo_depth.h) is searched as a sensor's would be. The strong planes of
/// the map stay what they are, but for those that fewer than 100 landmarks hold, which are
/// refitted, and those that most of the surface about them does not face: they become weak, as
/// slabs through what stands about. Poses and positions stay. `context` has the scale of the map;
/// the weak planes are forgotten.
void find_stereo_planes(Map& map, PlaneContext context, const StereoPlaneOptions& options);

}  // namespace planecast::slam
