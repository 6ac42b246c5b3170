#include "engine/sequence/synth/light_bake.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/sequence/synth/random.h"

namespace planecast::engine::synth {

namespace {

using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kLift = 1e-3F;          // rays start above the surface, metres
constexpr float kAmbientReach = 1.6F;   // beyond it, the surroundings count as open
constexpr float kContactScale = 0.45F;  // within about this far, surfaces take each other's light
constexpr float kSunRadius = 0.012F;    // a little more than the sun's 0.0047 rad, for haze
constexpr float kNegligible = 2e-4F;    // of what arrives; a grey level is ten times as much
constexpr float kBarShare = 0.045F;     // half a window bar over a pane's side

struct Site {
  Vector3f point;
  Vector3f normal;
  Vector3f tangent;
  Vector3f bitangent;
};

Site site_at(const Patch& patch, float u, float v) {
  Site site;
  site.normal = patch.normal(u, v);
  site.point = patch.position(u, v) + kLift * site.normal;
  const Vector3f hint =
      std::abs(site.normal.z()) < 0.9F ? Vector3f(Vector3f::UnitZ()) : Vector3f(Vector3f::UnitX());
  site.tangent = hint.cross(site.normal).normalized();
  site.bitangent = site.normal.cross(site.tangent);
  return site;
}

/// Cosine-distributed rays, stratified and turned at random from place to place.
Color ambient_at(const RoomModel& model, const std::vector<Color>& colors, const RayCaster& rays,
                 const Site& site, int count, Random& random) {
  Color sum = Color::Zero();
  const auto turn = static_cast<float>(random.uniform());
  for (int i = 0; i < count; ++i) {
    // Fibonacci spiral on the disc, lifted to the hemisphere.
    const float r2 = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const float angle = 2.0F * kPi * (turn + 0.61803399F * static_cast<float>(i));
    const float r = std::sqrt(r2);
    const Vector3f direction = r * std::cos(angle) * site.tangent +
                               r * std::sin(angle) * site.bitangent +
                               std::sqrt(1.0F - r2) * site.normal;
    const RayHit hit = rays.nearest(site.point, direction, kAmbientReach);
    if (hit.patch < 0) {
      sum += model.ambient;
      continue;
    }
    const float open = 1.0F - std::exp(-hit.distance / kContactScale);
    const Color tint = colors[static_cast<std::size_t>(hit.patch)];
    const Color bounced = model.ambient.cwiseProduct(0.45F * Color::Ones() + 0.9F * tint);
    sum += (0.12F + 0.88F * open) * bounced;
  }
  return sum / static_cast<float>(count);
}

Color window_at(const WindowLight& window, const RayCaster& rays, const Site& site, int count,
                Random& random) {
  const int side = std::max(1, static_cast<int>(std::sqrt(static_cast<float>(count))));
  const Vector3f cross = window.u_axis.cross(window.v_axis);
  const float area = cross.norm() / static_cast<float>(side * side);
  const Vector3f facing = cross.normalized();
  Color sum = Color::Zero();
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const float u =
          (static_cast<float>(i) + static_cast<float>(random.uniform())) / static_cast<float>(side);
      const float v =
          (static_cast<float>(j) + static_cast<float>(random.uniform())) / static_cast<float>(side);
      const Vector3f to =
          window.origin + u * window.u_axis + v * window.v_axis + 0.02F * facing - site.point;
      const float distance = to.norm();
      const Vector3f direction = to / distance;
      const float cos_here = site.normal.dot(direction);
      const float cos_there = -facing.dot(direction);
      if (cos_here <= 0.0F || cos_there <= 0.0F) continue;
      const float squared = std::max(distance * distance, 0.02F);
      const float share = cos_here * cos_there * area / (kPi * squared);
      if (share < kNegligible || rays.blocked(site.point, direction, distance - 0.01F)) continue;
      sum += share * window.radiance;
    }
  }
  return sum;
}

Color lamp_at(const LampLight& lamp, const RayCaster& rays, const Site& site, int count,
              Random& random) {
  Color sum = Color::Zero();
  for (int i = 0; i < count; ++i) {
    const Vector3f offset(static_cast<float>(random.uniform(-1, 1)),
                          static_cast<float>(random.uniform(-1, 1)),
                          static_cast<float>(random.uniform(-1, 1)));
    const Vector3f to = lamp.position + lamp.radius_m * offset - site.point;
    const float distance = to.norm();
    const float cosine = site.normal.dot(to) / distance;
    const float share = cosine / (kPi * std::max(distance * distance, 0.01F));
    if (share * lamp.intensity.maxCoeff() < 10.0F * kNegligible) continue;
    if (rays.blocked(site.point, to / distance, distance)) continue;
    sum += share * lamp.intensity;
  }
  return sum / static_cast<float>(count);
}

/// Distance along `direction` to the glass of a pane; negative when the ray does not pass one.
float distance_through_pane(const WindowLight& window, const Vector3f& point,
                            const Vector3f& direction) {
  const Vector3f facing = window.u_axis.cross(window.v_axis).normalized();
  const float slope = facing.dot(direction);
  if (slope >= -1e-4F) return -1.0F;
  const float distance = facing.dot(window.origin - point) / slope;
  if (distance <= 0.0F) return -1.0F;
  const Vector3f at = point + distance * direction - window.origin;
  const float u = at.dot(window.u_axis) / window.u_axis.squaredNorm();
  const float v = at.dot(window.v_axis) / window.v_axis.squaredNorm();
  if (u <= 0.0F || u >= 1.0F || v <= 0.0F || v >= 1.0F) return -1.0F;
  const float pane_u = u * static_cast<float>(window.pane_columns);
  const float pane_v = v * static_cast<float>(window.pane_rows);
  const float a = pane_u - std::floor(pane_u);
  const float b = pane_v - std::floor(pane_v);
  const bool bar = std::min({a, 1.0F - a, b, 1.0F - b}) < kBarShare;
  return bar ? -1.0F : distance;
}

/// Share of the sun's disc that shines on the site through a window.
float sun_share(const RoomModel& model, const RayCaster& rays, const Site& site, Random& random) {
  constexpr int kSide = 3;
  const Vector3f to_sun = model.sun.direction_to_sun;
  const Vector3f side = to_sun.cross(Vector3f::UnitZ()).normalized();
  const Vector3f other = to_sun.cross(side);
  int seen = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const float a = (static_cast<float>(i % kSide) + static_cast<float>(random.uniform())) / kSide;
    const float b = (static_cast<float>(i / kSide) + static_cast<float>(random.uniform())) / kSide;
    const Vector3f direction =
        (to_sun + kSunRadius * ((2.0F * a - 1.0F) * side + (2.0F * b - 1.0F) * other)).normalized();
    for (const WindowLight& window : model.windows) {
      const float reach = distance_through_pane(window, site.point, direction);
      if (reach > 0.0F && !rays.blocked(site.point, direction, reach - 0.01F)) {
        ++seen;
        break;
      }
    }
  }
  return static_cast<float>(seen) / (kSide * kSide);
}

int grid_side(float length_m, float texel_m, int most) {
  return std::clamp(static_cast<int>(std::lround(length_m / texel_m)), 2, most);
}

LightMap make_map(const Patch& patch, float texel_m, int most) {
  LightMap map;
  map.width = grid_side(patch.width_m, texel_m, most);
  map.height = grid_side(patch.height_m, texel_m, most);
  map.values.assign(static_cast<std::size_t>(map.width * map.height), Color::Zero());
  return map;
}

/// Removes the noise of few rays; a texel's own value keeps half of the weight.
void smooth(LightMap& map) {
  const std::vector<Color> before = map.values;
  const auto at = [&](int x, int y) -> const Color& {
    return before[static_cast<std::size_t>(std::clamp(y, 0, map.height - 1) * map.width +
                                           std::clamp(x, 0, map.width - 1))];
  };
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      Color sum = Color::Zero();
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          sum += at(x + dx, y + dy) * static_cast<float>((2 - std::abs(dx)) * (2 - std::abs(dy)));
        }
      }
      map.values[static_cast<std::size_t>(y * map.width + x)] = sum / 16.0F;
    }
  }
}

/// The sun's edge is sharp: it is found on a grid of its own, three times as fine.
void add_sun(const RoomModel& model, const RayCaster& rays, const Patch& patch, LightMap& map,
             float texel_m, Random& random) {
  LightMap fine = make_map(patch, texel_m / 3.0F, 700);
  bool any = false;
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(fine.width);
      const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(fine.height);
      const Site site = site_at(patch, u, v);
      const float cosine = site.normal.dot(model.sun.direction_to_sun);
      const float share = cosine > 0.0F ? sun_share(model, rays, site, random) : 0.0F;
      any = any || share > 0.0F;
      fine.values[static_cast<std::size_t>(y * fine.width + x)] =
          map.at(u, v) + share * std::max(cosine, 0.0F) * model.sun.radiance;
    }
  }
  if (any) map = std::move(fine);
}

}  // namespace

Color LightMap::at(float u, float v) const {
  const float x =
      std::clamp(u * static_cast<float>(width) - 0.5F, 0.0F, static_cast<float>(width - 1));
  const float y =
      std::clamp(v * static_cast<float>(height) - 0.5F, 0.0F, static_cast<float>(height - 1));
  const int ix = std::min(static_cast<int>(x), width - 2);
  const int iy = std::min(static_cast<int>(y), height - 2);
  const float tx = x - static_cast<float>(ix);
  const float ty = y - static_cast<float>(iy);
  const Color* row = &values[static_cast<std::size_t>(iy * width + ix)];
  const Color low = row[0] + (row[1] - row[0]) * tx;
  const Color high = row[width] + (row[width + 1] - row[width]) * tx;
  return low + (high - low) * ty;
}

Color mean_color(const Patch& patch) {
  Color sum = Color::Zero();
  constexpr int kSide = 8;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      sum += patch.texture(patch.width_m * (static_cast<float>(i) + 0.37F) / kSide,
                           patch.height_m * (static_cast<float>(j) + 0.61F) / kSide);
    }
  }
  return sum / (kSide * kSide);
}

LightMap bake_light(const RoomModel& model, const std::vector<Color>& mean_colors,
                    const RayCaster& rays, int patch_index, const BakeOptions& options) {
  const Patch& patch = model.patches[static_cast<std::size_t>(patch_index)];
  const float texel_m = patch.light_texel_m / options.detail;
  LightMap map = make_map(patch, texel_m, 256);
  if (patch.shines) {
    map.values.assign(map.values.size(), Color::Ones());
    return map;
  }
  const BakeRays& count = patch.label != 0 ? options.flat : options.small;
  Random random(named_seed("light", static_cast<std::uint64_t>(patch_index)));
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const Site site =
          site_at(patch, (static_cast<float>(x) + 0.5F) / static_cast<float>(map.width),
                  (static_cast<float>(y) + 0.5F) / static_cast<float>(map.height));
      Color sum = ambient_at(model, mean_colors, rays, site, count.ambient, random);
      for (const WindowLight& window : model.windows) {
        sum += window_at(window, rays, site, count.window, random);
      }
      for (const LampLight& lamp : model.lamps) {
        sum += lamp_at(lamp, rays, site, count.lamp, random);
      }
      map.values[static_cast<std::size_t>(y * map.width + x)] = sum;
    }
  }
  smooth(map);
  if (!model.sun.radiance.isZero() && !model.windows.empty()) {
    add_sun(model, rays, patch, map, texel_m, random);
  }
  return map;
}

}  // namespace planecast::engine::synth
