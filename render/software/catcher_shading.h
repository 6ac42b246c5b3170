#pragma once

#include <glm/glm.hpp>

#include "render/image.h"
#include "render/software/lanes.h"
#include "render/software/mip_texture.h"
#include "render/software/penumbra_map.h"

namespace planecast::render {

/// An image of one channel over a rectangle, as a plane's points see it: texel = scale * point +
/// offset, (0, 0) being the centre of the first.
struct PlaneImage {
  const ImageF* image = nullptr;
  glm::vec2 scale{};
  glm::vec2 offset{};
};

/// What the shadow on a plane is computed from; see catcher.frag. Points are on the plane, metres.
struct CatcherMaps {
  PlaneImage mask;  ///< distance to the polygon's edge, metres
  float edge_softness_m = 0.0F;

  PlaneImage contact;  ///< no image: no contact shadow
  float contact_strength = 0.0F;

  const PenumbraLevels* penumbra = nullptr;  ///< null: no sun
  glm::mat3x2 sun_from_plane{};              ///< share of the sun's map
  float penumbra_texel_m = 0.0F;
  float penumbra_extent_m = 0.0F;
  float light_tangent = 0.0F;
  float farthest_gap_m = 0.0F;
  float smallest_radius_m = 0.0F;
};

/// Shares of the light that are hidden at kLanes points, the surroundings' (red) and the sun's
/// (green), and how far inside the polygon they are (blue).
void shade_catcher(const CatcherMaps& maps, const Lane& x, const Lane& y, TextureReads& out);

}  // namespace planecast::render
