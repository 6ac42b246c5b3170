#pragma once

#include <filesystem>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// map_changes.csv: `frame,kind,id,tx,ty,tz,qx,qy,qz,qw`. Each change begins with a line of kind
/// `map` (id 0): how the map moved about the camera; then one line a known plane (`plane` and its
/// id: world from its own frame) and one a new or moved keyframe (`keyframe` and its frame: world
/// from its camera).
void write_map_changes(const std::vector<MapChange>& changes, const std::filesystem::path& path);
/// Reads it back; nothing where there is no such file. Throws UserError naming file and line.
std::vector<MapChange> read_map_changes(const std::filesystem::path& path);

}  // namespace planecast::engine
