#pragma once

#include "engine/pipeline/reconstruction.h"
#include "slam/data/map.h"

namespace planecast::engine {

/// Keyframes, planes with their polygons and points of a finished map; weak planes are left out. Plane
/// classes and `up` are not set here.
Reconstruction map_to_records(const slam::Map& map, const slam::Camera& camera, bool metric);

}  // namespace planecast::engine
