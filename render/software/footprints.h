#pragma once

#include <glm/glm.hpp>

#include "render/software/lanes.h"
#include "render/software/mip_texture.h"

namespace planecast::render {

/// Texture coordinates of points and their change by a pixel to the right and down.
struct alignas(64) FootprintLanes {
  Lane u, v;
  Lane u_across, v_across;
  Lane u_down, v_down;
};

/// One read for each lane, trilinear as OpenGL's own: the level for the longer side of the pixel's
/// footprint. `transform`: of the texture's slot.
void place_trilinear(const FootprintLanes& points, const glm::mat3& transform, glm::vec2 size,
                     TextureReads& reads);

/// As stretched.glsl: several taps along the longer axis of the pixel's footprint.
struct StretchedTaps {
  LaneInt of_lane;  ///< how many
};
/// Places the taps of the first `count` lanes one after another.
StretchedTaps place_stretched(const FootprintLanes& points, std::size_t count,
                              const glm::mat3& transform, glm::vec2 size, TextureReads& reads);
/// The mean of each lane's taps. `decode`: taps hold encoded colours.
void gather_stretched(const StretchedTaps& taps, std::size_t count, bool decode,
                      TextureReads& reads, Lane& red, Lane& green, Lane& blue);

}  // namespace planecast::render
