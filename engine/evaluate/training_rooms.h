#pragma once

#include <cstdint>

#include "engine/evaluate/masks.h"
#include "slam/segmentation/plane_segmenter.h"

namespace planecast::engine {

/// Seeds of rooms that are in no training set: choices are made on the first, figures reported on
/// the second.
inline constexpr std::uint64_t kValidationRooms = 800000;
inline constexpr std::uint64_t kHeldOutRooms = 900000;

/// Draws one view of each of the rooms `first`, first + 1, ... and compares the masks. Planes under
/// half a percent of the picture count as not planar.
MaskResult evaluate_on_rooms(slam::PlaneSegmenter& segmenter, std::uint64_t first, int rooms);

}  // namespace planecast::engine
