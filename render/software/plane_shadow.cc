#include "render/software/plane_shadow.h"

#include <algorithm>
#include <cmath>

#include "render/passes/view.h"

namespace planecast::render {

// Compiled for several instruction sets: names that others see.
void project_row(const ShadowProjector& projector, float u, float v, TextureReads& reads,
                 Lane& depth);
void alphas_of(const TextureReads& reads, float sun_share, float strength, LaneInt& alphas);

PLANECAST_WIDE void project_row(const ShadowProjector& p, float u, float v, TextureReads& reads,
                                Lane& depth) {
  // Along a row: value = slope * column + start.
  const float x_slope = p.row_x.x;
  const float y_slope = p.row_y.x;
  const float n_slope = p.normal.x;
  const float x_down = p.row_x.y;
  const float y_down = p.row_y.y;
  const float n_down = p.normal.y;
  const float x_start = x_slope * u + x_down * v + p.row_x.z;
  const float y_start = y_slope * u + y_down * v + p.row_y.z;
  const float n_start = n_slope * u + n_down * v + p.normal.z;
  const float eye_x = p.eye.x;
  const float eye_y = p.eye.y;
  const float height = p.height;
  const float scale_x = p.scale.x;
  const float scale_y = p.scale.y;
  const float texels_per_m_x = scale_x * p.size.x;
  const float texels_per_m_y = scale_y * p.size.y;
  Lane at_u;
  Lane at_v;
  Lane level;
  Lane distance;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto column = static_cast<float>(static_cast<std::int32_t>(i));
    const float inverse = 1.0F / (n_slope * column + n_start);
    const float t = height * inverse;
    distance[i] = t;
    const float x = x_slope * column + x_start;
    const float y = y_slope * column + y_start;
    // Change of the texel by a pixel to the right and down.
    const float texels_x = t * texels_per_m_x;
    const float texels_y = t * texels_per_m_y;
    const float x_share = x * inverse;
    const float y_share = y * inverse;
    const float across_x = std::abs(texels_x * (x_slope - x_share * n_slope));
    const float across_y = std::abs(texels_y * (y_slope - y_share * n_slope));
    const float down_x = std::abs(texels_x * (x_down - x_share * n_down));
    const float down_y = std::abs(texels_y * (y_down - y_share * n_down));
    const float longest = larger(larger(across_x, across_y), larger(down_x, down_y));
    at_u[i] = (eye_x + t * x) * scale_x;
    at_v[i] = (eye_y + t * y) * scale_y;
    // Seen at a slant, the level for the longer side of the footprint would blur across the
    // shorter.
    level[i] = fast_log2(smaller(larger(longest, 1e-6F), 1e6F)) - 1.0F;
  }
  std::ranges::copy(at_u, reads.u.begin());
  std::ranges::copy(at_v, reads.v.begin());
  std::ranges::copy(level, reads.level.begin());
  reads.count = kLanes;
  depth = distance;  // rays are one long along the optical axis
}

/// Alpha that darkens an encoded picture as much as the light that is left says: multiplying light
/// by k multiplies the picture by about k^(1 / 2.2).
PLANECAST_WIDE void alphas_of(const TextureReads& reads, float sun_share, float strength,
                              LaneInt& alphas) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float lost = (1.0F - sun_share) * reads.red[i] + sun_share * reads.green[i];
    const float kept = smaller(larger(1.0F - strength * lost, 1e-6F), 1.0F);
    const float alpha = 1.0F - exp2_of_negative(fast_log2(kept) * (1.0F / 2.2F));
    alphas[i] = static_cast<std::int32_t>(255.0F * alpha * reads.blue[i] + 0.5F);
  }
}

PlaneShadow::PlaneShadow(const ShadowOnPlane& shadow, const Camera& camera, float strength,
                         const DepthOcclusion& occlusion)
    : shadow_(&shadow), strength_(std::clamp(strength, 0.0F, 1.0F)), occlusion_(occlusion) {
  const PlaneFrame& frame = shadow.frame;
  const glm::vec3 eye = camera_position(camera);
  // Directions of the world per pixel: a ray is columns * (u, v, 1).
  const glm::mat3 world_from_camera = glm::inverse(glm::mat3(camera.camera_from_world));
  const glm::mat3 camera_from_pixel(
      glm::vec3(1.0F / camera.fx, 0.0F, 0.0F), glm::vec3(0.0F, 1.0F / camera.fy, 0.0F),
      glm::vec3(-camera.cx / camera.fx, -camera.cy / camera.fy, 1.0F));
  const glm::mat3 rays = world_from_camera * camera_from_pixel;
  projector_.eye = frame.coordinates(eye);
  projector_.height = -frame.height(eye);
  projector_.row_x = frame.x * rays;
  projector_.row_y = frame.y * rays;
  projector_.normal = frame.normal * rays;
  if (shadow.baked == nullptr) return;
  projector_.eye -= shadow.over.min;
  projector_.scale = 1.0F / shadow.over.size();
  projector_.size = shadow.baked->size();
}

void PlaneShadow::read(int u, int v, LaneInt& alphas) {
  project_row(projector_, static_cast<float>(u), static_cast<float>(v), reads_, depth_);
  if (shadow_->baked != nullptr) {
    shadow_->baked->read(reads_);
  } else {
    Lane x;
    Lane y;
    std::copy_n(reads_.u.begin(), kLanes, x.begin());
    std::copy_n(reads_.v.begin(), kLanes, y.begin());
    shade_catcher(shadow_->maps, x, y, reads_);
  }
  alphas_of(reads_, shadow_->sun_share, strength_, alphas);
  if (occlusion_.depth != nullptr) hide(u, v, alphas);
}

/// What lies behind the depth image does not get dark.
void PlaneShadow::hide(int u, int v, LaneInt& alphas) const {
  LaneInt columns;
  LaneInt rows;
  rows.fill(v);
  for (std::size_t i = 0; i < kLanes; ++i) columns[i] = u + static_cast<int>(i);
  Lane visible;
  find_visibility(occlusion_, columns, rows, depth_, visible);
  for (std::size_t i = 0; i < kLanes; ++i) {
    alphas[i] = static_cast<int>(static_cast<float>(alphas[i]) * visible[i] + 0.5F);
  }
}

std::uint32_t darkened(std::uint32_t samples, unsigned bits, unsigned alpha) {
  if (samples == 0 && bits == 15U) return alpha * 0x01010101U;
  std::uint32_t result = samples;
  for (unsigned s = 0; s < 4; ++s) {
    if ((bits >> s & 1U) == 0) continue;
    const unsigned before = samples >> (8U * s) & 0xFFU;
    const unsigned after = alpha + (before * (255U - alpha) + 127U) / 255U;
    result = (result & ~(0xFFU << (8U * s))) | after << (8U * s);
  }
  return result;
}

}  // namespace planecast::render
