#pragma once

#include "engine/pipeline/reconstruction.h"
#include "slam/data/map.h"

namespace planecast::engine {

/// Keyframes from `first_keyframe` on, planes with their polygons and points of a finished map;
/// weak planes are left out. Plane classes and `up` are not set here.
Reconstruction map_to_records(const slam::Map& map, const slam::Camera& camera, bool metric,
                              slam::KeyframeId first_keyframe = 0);

}  // namespace planecast::engine
