#pragma once

#include <filesystem>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// map.bin holds what the readable files of a reconstruction folder do not, exactly: camera, mode,
/// segmentation, scale, warnings, and the map itself with what is needed to go on from it. No
/// times: the file is the same bytes for the same input.
///
/// Layout, little endian: 8 bytes "PLNCMAP" 0, uint32 version (2), uint64 size of what follows the
/// header, uint64 its FNV-1a checksum; then chunks until the end: 4 bytes tag, uint64 size,
/// payload. CAMR camera, ABOU about the run, SLAM the map (slam/data/map_archive.h), PICT the
/// keyframes' grey pictures as PNG. Readers skip chunks they do not know, so that later versions
/// may add.
void write_map_bin(const Reconstruction& reconstruction, const std::filesystem::path& path);

/// Sets those members of `reconstruction`; the map only `with_map`. Throws UserError for another
/// version or a broken file.
void read_map_bin(const std::filesystem::path& path, Reconstruction& reconstruction,
                  bool with_map = false);

}  // namespace planecast::engine
