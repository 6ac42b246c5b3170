#pragma once

#include <filesystem>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// map.ply: binary little endian, one vertex a point: x y z (double, world), red green blue (the
/// colour of its plane, palette.h), plane (int, -1 = none), image_red image_green image_blue
/// (float, 0..255, as seen in the images).
void write_ply(const std::vector<MapPoint>& points, const std::filesystem::path& path);

/// Reads back exactly what write_ply wrote; any other layout, or a truncated file, is a UserError.
std::vector<MapPoint> read_ply(const std::filesystem::path& path);

}  // namespace planecast::engine
