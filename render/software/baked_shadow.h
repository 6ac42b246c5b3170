#pragma once

#include <cstdint>

#include "render/passes/plane_frame.h"
#include "render/scene.h"
#include "render/software/mip_texture.h"

namespace planecast::render {

/// A baked shadow on a plane; see catcher.frag.
struct ShadowOnPlane {
  PlaneFrame frame;
  PlaneRegion dark;  ///< what is drawn
  PlaneRegion over;  ///< what the texture covers
  const MipTexture* baked = nullptr;
  float sun_share = 0.0F;
};

/// What turns pixels into places of a baked shadow. Plane coordinates = eye + height * (row .
/// pixel) / (normal . pixel), pixel = (u, v, 1).
struct ShadowProjector {
  glm::vec2 eye{};  ///< from the covered region's corner
  float height = 0.0F;
  glm::vec3 row_x{};
  glm::vec3 row_y{};
  glm::vec3 normal{};
  glm::vec2 scale{};  ///< texture coordinates per metre
  glm::vec2 size{};   ///< texels
};

/// Reads a baked shadow as catcher.frag does.
class BakedShadow {
 public:
  BakedShadow(const ShadowOnPlane& shadow, const Camera& camera, float strength);

  /// Alphas, 0..255, at the centres of kLanes pixels of the picture's row `v` from `u` on.
  void read(int u, int v, LaneInt& alphas);

 private:
  const ShadowOnPlane* shadow_;
  float strength_;
  ShadowProjector projector_;
  TextureReads reads_;
};

/// Black of that alpha over the samples whose bits are set; a byte a sample.
std::uint32_t darkened(std::uint32_t samples, unsigned bits, unsigned alpha);

}  // namespace planecast::render
