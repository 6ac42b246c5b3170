#pragma once

#include <array>
#include <cstdint>

namespace planecast::engine {

using Rgb = std::array<std::uint8_t, 3>;

/// Colour of what belongs to no plane.
inline constexpr Rgb kNoPlaneColor = {150, 150, 150};

/// The colour of a plane in every output (map.ply, scene.glb, report, debug overlay): stable by id,
/// neighbouring ids far apart in hue. Negative ids give kNoPlaneColor.
Rgb plane_color(int plane_id);

}  // namespace planecast::engine
