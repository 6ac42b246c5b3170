#pragma once

#include <cstdint>

#include "render/passes/plane_frame.h"
#include "render/scene.h"
#include "render/software/catcher_shading.h"
#include "render/software/depth_occlusion.h"
#include "render/software/mip_texture.h"

namespace planecast::render {

/// A shadow on a plane; see catcher.frag.
struct ShadowOnPlane {
  PlaneFrame frame;
  PlaneRegion dark;  ///< what is drawn
  float sun_share = 0.0F;
  CatcherMaps maps;                   ///< what it is computed from where it is not baked
  const MipTexture* baked = nullptr;  ///< what shade_catcher() finds over `over`; may be null
  PlaneRegion over;
};

/// What turns pixels into places on a plane. Plane coordinates = eye + height * (row . pixel) /
/// (normal . pixel), pixel = (u, v, 1).
struct ShadowProjector {
  glm::vec2 eye{};  ///< from the corner of what is read
  float height = 0.0F;
  glm::vec3 row_x{};
  glm::vec3 row_y{};
  glm::vec3 normal{};
  glm::vec2 scale = glm::vec2(1.0F);  ///< coordinates of what is read per metre
  glm::vec2 size = glm::vec2(1.0F);   ///< texels
};

/// Reads the shadow on a plane as catcher.frag does.
class PlaneShadow {
 public:
  PlaneShadow(const ShadowOnPlane& shadow, const Camera& camera, float strength,
              const DepthOcclusion& occlusion);

  /// Alphas, 0..255, at the centres of kLanes pixels of the picture's row `v` from `u` on.
  void read(int u, int v, LaneInt& alphas);

 private:
  void hide(int u, int v, LaneInt& alphas) const;

  const ShadowOnPlane* shadow_;
  float strength_;
  DepthOcclusion occlusion_;
  ShadowProjector projector_;
  TextureReads reads_;
  Lane depth_{};  ///< of the plane at the pixels
};

/// Black of that alpha over the samples whose bits are set; a byte a sample.
std::uint32_t darkened(std::uint32_t samples, unsigned bits, unsigned alpha);

}  // namespace planecast::render
