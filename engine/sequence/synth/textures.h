#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

namespace planecast::engine::synth {

/// Linear RGB reflectance (or radiance of what shines by itself).
using Color = Eigen::Vector3f;

/// Reflectance at (u, v) metres on a surface, u to the right and v upwards as one looks at it.
using Texture = std::function<Color(float u_m, float v_m)>;

/// 0xRRGGBB as on a screen -> linear.
Color color_from_srgb(std::uint32_t rgb);

Texture plain(const Color& color);
/// Painted wall: faint roller marks, mottling and grain.
Texture plaster(const Color& base, std::uint32_t seed);
/// Boards along u with grain and knots; `gap_m` of shadow between them (0: glued).
struct WoodOptions {
  Color light;
  Color dark;
  float board_width_m = 0.12F;
  float board_length_m = 1.2F;
  float gap_m = 0.0F;
  float variation = 0.15F;  ///< of the brightness between boards
};
Texture wood(const WoodOptions& options, std::uint32_t seed);
Texture tiles(const Color& tile, const Color& grout, float size_m, std::uint32_t seed);
Texture bricks(const Color& brick, const Color& mortar, std::uint32_t seed);
/// Short fibres with flecks of a second colour.
Texture carpet(const Color& base, const Color& fleck, std::uint32_t seed);
/// Woven threads.
Texture fabric(const Color& base, std::uint32_t seed);
/// Fired clay, fruit, leaves: blotches of two colours at the given size.
Texture mottled(const Color& a, const Color& b, float size_m, std::uint32_t seed);
/// A woven rug of the given size with borders, medallions and fringes.
Texture rug(float width_m, float height_m, std::uint32_t seed);
/// A picture (8-bit BGR) stretched over width x height metres.
Texture picture(const cv::Mat& bgr, float width_m, float height_m);

/// Something flat on a surface that shares its plane: a print, a rug, a skirting board.
struct Decal {
  float u_m = 0.0F;  ///< lower left corner on the surface
  float v_m = 0.0F;
  float width_m = 0.0F;
  float height_m = 0.0F;
  Texture texture;
  float shadow_m = 0.0F;  ///< width of the soft dark rim that its thickness would throw
  float yaw = 0.0F;       ///< radians, about its centre
};
Texture with_decals(Texture base, std::vector<Decal> decals);

}  // namespace planecast::engine::synth
