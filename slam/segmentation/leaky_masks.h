#pragma once

#include <cstdint>
#include <memory>

#include "slam/segmentation/plane_segmenter.h"

namespace planecast::slam {

/// Wraps a segmenter and corrupts its masks, to measure what fitting makes of bad ones: every
/// instance leaks from a random pixel of its border into whatever adjoins, a disc about that pixel,
/// until `share` (0 .. 0.9) of its pixels are not its own; what one instance has taken no other
/// takes. Repeatable for a seed and frame; frames are independent of each other.
std::unique_ptr<PlaneSegmenter> make_leaky_segmenter(std::unique_ptr<PlaneSegmenter> inner,
                                                     double share, std::uint64_t seed);

}  // namespace planecast::slam
