#pragma once

#include <filesystem>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// map.bin holds what the readable files of a reconstruction folder do not, exactly: camera, mode,
/// segmentation, scale, warnings. No times: the file is the same bytes for the same input.
///
/// Layout, little endian: 8 bytes "PLNCMAP" 0, uint32 version (1), then chunks until the end: 4
/// bytes tag, uint64 size, payload. Readers skip chunks they do not know, so that later versions
/// may add.
void write_map_bin(const Reconstruction& reconstruction, const std::filesystem::path& path);

/// Sets those members of `reconstruction`. Throws UserError for another version or a broken file.
void read_map_bin(const std::filesystem::path& path, Reconstruction& reconstruction);

}  // namespace planecast::engine
