#pragma once

#include <filesystem>
#include <vector>

#include "engine/output/video.h"

namespace planecast::engine {

/// Joins the segments into one MP4 by stream copy: frame n of the whole gets time n / rate. Throws
/// UserError naming a segment that cannot be read or was encoded with other settings.
void join_segments(const std::vector<std::filesystem::path>& segments, FrameRate rate,
                   const std::filesystem::path& path);

}  // namespace planecast::engine
