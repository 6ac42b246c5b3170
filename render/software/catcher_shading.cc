#include "render/software/catcher_shading.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/software/float_lanes.h"

namespace planecast::render {
namespace {

constexpr std::size_t kTaps = 12;
constexpr float kSomething = 1e-3F;  ///< share of blocked rays below which there is no shadow

/// Sunflower points fill a disc of radius 1 evenly.
std::array<glm::vec2, kTaps> sunflower() {
  std::array<glm::vec2, kTaps> points;
  for (std::size_t i = 0; i < kTaps; ++i) {
    const auto number = static_cast<float>(i);
    const float angle = 2.3999632F * number;
    points[i] = glm::vec2(std::cos(angle), std::sin(angle)) *
                std::sqrt((number + 0.5F) / static_cast<float>(kTaps));
  }
  return points;
}

const std::array<glm::vec2, kTaps> kSunflower = sunflower();

/// Places in a penumbra map: shares of its sides, and levels.
struct alignas(64) PenumbraPlaces {
  Lane u, v, level;
};

PLANECAST_INLINE void read_level(const PenumbraLevels& map, const float* texels,
                                 const LaneInt& level, const PenumbraPlaces& at, Lane& out) {
  LaneInt first;
  LaneInt side;
  Lane x;
  Lane y;
  for (std::size_t i = 0; i < kLanes; ++i) {
    first[i] = map.first[static_cast<std::size_t>(level[i])];
    side[i] = map.side[static_cast<std::size_t>(level[i])];
    // The border is one texel; a place is half a texel from its texel's centre.
    const auto inner = static_cast<float>(side[i] - 2);
    x[i] = at.u[i] * inner + 0.5F;
    y[i] = at.v[i] * inner + 0.5F;
  }
  blend_clamped(texels, first, side, side, x, y, out);
}

/// Trilinear, of one of the map's channels.
PLANECAST_INLINE void read(const PenumbraLevels& map, const float* texels, const PenumbraPlaces& at,
                           Lane& out) {
  const std::int32_t last = map.count - 1;
  LaneInt finer;
  LaneInt coarser;
  Lane share;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float level = smaller(larger(at.level[i], 0.0F), static_cast<float>(last));
    finer[i] = static_cast<std::int32_t>(level);
    coarser[i] = finer[i] < last ? finer[i] + 1 : last;
    share[i] = level - static_cast<float>(finer[i]);
  }
  Lane near;
  Lane far;
  read_level(map, texels, finer, at, near);
  read_level(map, texels, coarser, at, far);
  for (std::size_t i = 0; i < kLanes; ++i) out[i] = near[i] + share[i] * (far[i] - near[i]);
}

PLANECAST_INLINE float level_of(float width_m, float texels_per_m) {
  return fast_log2(larger(width_m * texels_per_m, 1.0F));
}

PLANECAST_INLINE void read_plane_image(const PlaneImage& map, const Lane& x, const Lane& y,
                                       Lane& out) {
  LaneInt first{};
  LaneInt width;
  LaneInt height;
  width.fill(map.image->width);
  height.fill(map.image->height);
  Lane at_x;
  Lane at_y;
  for (std::size_t i = 0; i < kLanes; ++i) {
    at_x[i] = map.scale.x * x[i] + map.offset.x;
    at_y[i] = map.scale.y * y[i] + map.offset.y;
  }
  blend_clamped(map.image->pixels.data(), first, width, height, at_x, at_y, out);
}

}  // namespace

// Compiled for several instruction sets: names that others see.
void shade_mask(const CatcherMaps& maps, const Lane& x, const Lane& y, Lane& inside);
void shade_contact(const CatcherMaps& maps, const Lane& x, const Lane& y, Lane& hidden);
bool find_radius(const CatcherMaps& maps, const Lane& x, const Lane& y, PenumbraPlaces& places,
                 Lane& radius);
void shade_sun(const CatcherMaps& maps, const PenumbraPlaces& places, const Lane& radius,
               Lane& hidden);

PLANECAST_WIDE void shade_mask(const CatcherMaps& maps, const Lane& x, const Lane& y,
                               Lane& inside) {
  Lane edge;
  read_plane_image(maps.mask, x, y, edge);
  const float per_m = 1.0F / larger(maps.edge_softness_m, 1e-6F);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float t = smaller(larger(edge[i] * per_m, 0.0F), 1.0F);
    inside[i] = t * t * (3.0F - 2.0F * t);
  }
}

PLANECAST_WIDE void shade_contact(const CatcherMaps& maps, const Lane& x, const Lane& y,
                                  Lane& hidden) {
  Lane share;
  read_plane_image(maps.contact, x, y, share);
  const auto right = static_cast<float>(maps.contact.image->width) - 0.5F;
  const auto bottom = static_cast<float>(maps.contact.image->height) - 0.5F;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float at_x = maps.contact.scale.x * x[i] + maps.contact.offset.x;
    const float at_y = maps.contact.scale.y * y[i] + maps.contact.offset.y;
    const bool inside = (at_x > -0.5F) & (at_y > -0.5F) & (at_x < right) & (at_y < bottom);
    hidden[i] = inside ? maps.contact_strength * share[i] : 0.0F;
  }
}

/// Width of the light as seen from each point through the nearest blockers, 0 where there are none;
/// whether any point has some.
PLANECAST_WIDE bool find_radius(const CatcherMaps& maps, const Lane& x, const Lane& y,
                                PenumbraPlaces& places, Lane& radius) {
  const glm::mat3x2 m = maps.sun_from_plane;
  const PenumbraLevels& map = *maps.penumbra;
  const float tangent = maps.light_tangent;
  const float smallest = maps.smallest_radius_m;
  const float texels_per_m = 1.0F / maps.penumbra_texel_m;
  const float widest = larger(tangent * maps.farthest_gap_m, smallest);
  PenumbraPlaces at;
  at.level.fill(level_of(2.0F * widest, texels_per_m));
  for (std::size_t i = 0; i < kLanes; ++i) {
    at.u[i] = m[0][0] * x[i] + m[1][0] * y[i] + m[2][0];
    at.v[i] = m[0][1] * x[i] + m[1][1] * y[i] + m[2][1];
  }
  Lane blocked;
  Lane gap;
  read(map, map.blocked.data(), at, blocked);
  std::int32_t any = 0;
  for (std::size_t i = 0; i < kLanes; ++i) any |= blocked[i] > kSomething ? 1 : 0;
  if (any == 0) return false;
  read(map, map.gap_m.data(), at, gap);
  Lane first;
  Lane shaded;
  for (std::size_t i = 0; i < kLanes; ++i) {
    shaded[i] = blocked[i] > kSomething ? 1.0F : 0.0F;
    first[i] = larger(tangent * gap[i] / larger(blocked[i], 1e-6F), smallest);
    at.level[i] = level_of(2.0F * first[i], texels_per_m);
  }
  read(map, map.blocked.data(), at, blocked);
  read(map, map.gap_m.data(), at, gap);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float found = larger(tangent * gap[i] / larger(blocked[i], 1e-6F), smallest);
    radius[i] = shaded[i] * (blocked[i] > kSomething ? found : first[i]);
  }
  places = at;
  return true;
}

/// The share of the light that blockers hide.
PLANECAST_WIDE void shade_sun(const CatcherMaps& maps, const PenumbraPlaces& places,
                              const Lane& radius, Lane& hidden) {
  const PenumbraLevels& map = *maps.penumbra;
  const float texels_per_m = 1.0F / maps.penumbra_texel_m;
  const float shares_per_m = 1.0F / maps.penumbra_extent_m;
  Lane sum{};
  PenumbraPlaces at;
  for (std::size_t i = 0; i < kLanes; ++i) {
    at.level[i] = level_of(0.9F * radius[i], texels_per_m);
  }
  for (const glm::vec2& point : kSunflower) {
    const float dx = point.x * shares_per_m;
    const float dy = point.y * shares_per_m;
    for (std::size_t i = 0; i < kLanes; ++i) {
      at.u[i] = places.u[i] + radius[i] * dx;
      at.v[i] = places.v[i] + radius[i] * dy;
    }
    Lane blocked;
    read(map, map.blocked.data(), at, blocked);
    for (std::size_t i = 0; i < kLanes; ++i) sum[i] += blocked[i];
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    hidden[i] = radius[i] > 0.0F ? sum[i] * (1.0F / static_cast<float>(kTaps)) : 0.0F;
  }
}

void shade_catcher(const CatcherMaps& maps, const Lane& x, const Lane& y, TextureReads& out) {
  Lane contact{};
  Lane sun{};
  Lane inside;
  shade_mask(maps, x, y, inside);
  if (maps.contact.image != nullptr) shade_contact(maps, x, y, contact);
  if (maps.penumbra != nullptr) {
    PenumbraPlaces places;
    Lane radius;
    if (find_radius(maps, x, y, places, radius)) shade_sun(maps, places, radius, sun);
  }
  std::ranges::copy(contact, out.red.begin());
  std::ranges::copy(sun, out.green.begin());
  std::ranges::copy(inside, out.blue.begin());
  out.count = kLanes;
}

}  // namespace planecast::render
