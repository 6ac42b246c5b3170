#include "render/software/surface_lanes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "render/software/lane_vec.h"
#include "render/software/lanes.h"

// Plain arithmetic without branches or calls, so that the compiler puts neighbouring lanes side by
// side. The formulas are those of brdf.glsl, ambient.glsl and model.frag.
namespace planecast::render {
namespace {

constexpr float kSmallestCosine = 1e-3F;
constexpr float kDielectric = 0.04F;

struct Sh {
  std::array<Vec, 9> c;
};

PLANECAST_INLINE Sh load_sh(const std::array<glm::vec3, 9>& sh) {
  Sh result{};
  for (std::size_t i = 0; i < 9; ++i) result.c[i] = vec(sh[i]);
  return result;
}

PLANECAST_INLINE Vec evaluate_sh(const Sh& sh, Vec n, float band0, float band1, float band2) {
  Vec sum = sh.c[0] * (0.282095F * band0);
  const float first = 0.488603F * band1;
  sum = sum + sh.c[1] * (first * n.y) + sh.c[2] * (first * n.z) + sh.c[3] * (first * n.x);
  const float second = 1.092548F * band2;
  sum = sum + sh.c[4] * (second * n.x * n.y) + sh.c[5] * (second * n.y * n.z) +
        sh.c[7] * (second * n.x * n.z);
  sum = sum + sh.c[6] * (0.315392F * band2 * (3.0F * n.z * n.z - 1.0F)) +
        sh.c[8] * (0.546274F * band2 * (n.x * n.x - n.y * n.y));
  return {larger(sum.x, 0.0F), larger(sum.y, 0.0F), larger(sum.z, 0.0F)};
}

PLANECAST_INLINE float root_of_color(float linear) {
  return std::sqrt(smaller(larger(linear, 0.0F), 1.0F));
}

/// What the mirrored eye sees of the harmonics, blurred by roughness.
PLANECAST_INLINE Vec reflected_sh(const Sh& sh, Vec n, Vec v, float alpha) {
  constexpr float kLog2E = 1.44269504F;
  const Vec mirrored = n * (2.0F * dot(n, v)) - v;
  return evaluate_sh(sh, mirrored, 1.0F, exp2_of_negative(-0.45F * kLog2E * alpha),
                     exp2_of_negative(-1.4F * kLog2E * alpha));
}

/// The surroundings' light that leaves towards the eye; `reflected`: what the mirrored eye sees.
PLANECAST_INLINE Vec ambient_light(const Sh& sh, Vec n, Vec reflected, Vec diffuse, Vec f0,
                                   float roughness, float n_dot_v) {
  const float rx = 1.0F - roughness;
  const float ry = 0.0425F - 0.0275F * roughness;
  const float rz = 1.04F - 0.572F * roughness;
  const float rw = 0.022F * roughness - 0.04F;
  const float a = smaller(rx * rx, exp2_of_negative(-9.28F * n_dot_v)) * rx + ry;
  const float scale = -1.04F * a + rz;
  const float bias = 1.04F * a + rw;
  const float again = 1.0F / larger(scale + bias, 1e-3F) - 1.0F;
  const auto specular = [&](float f) { return (f * scale + bias) * (1.0F + f * again); };
  const Vec s = {specular(f0.x), specular(f0.y), specular(f0.z)};
  const Vec irradiance = evaluate_sh(sh, n, 1.0F, 2.0F / 3.0F, 0.25F);
  const Vec kept = {1.0F - s.x, 1.0F - s.y, 1.0F - s.z};
  return diffuse * kept * irradiance + s * reflected;
}

/// The sun's light that leaves towards the eye, per irradiance / pi that arrives.
PLANECAST_INLINE Vec sun_light(Vec n, Vec v, Vec l, Vec diffuse, Vec f0, float alpha, float n_dot_v,
                               float n_dot_l) {
  const Vec h = normalized(l + v);
  const float n_dot_h = larger(dot(n, h), 0.0F);
  const float a2 = alpha * alpha;
  const float d = n_dot_h * n_dot_h * (a2 - 1.0F) + 1.0F;
  const float visible = n_dot_l * std::sqrt(n_dot_v * n_dot_v * (1.0F - a2) + a2) +
                        n_dot_v * std::sqrt(n_dot_l * n_dot_l * (1.0F - a2) + a2);
  const float ggx = 0.5F * a2 / (d * d * larger(visible, 1e-5F));
  const float away = 1.0F - larger(dot(v, h), 0.0F);
  const float away2 = away * away;
  const float grazing = away2 * away2 * away;
  const auto reflected = [&](float f0_of, float diffuse_of) {
    const float f = f0_of + (1.0F - f0_of) * grazing;
    return (diffuse_of * (1.0F - f) + f * ggx) * n_dot_l;
  };
  return {reflected(f0.x, diffuse.x), reflected(f0.y, diffuse.y), reflected(f0.z, diffuse.z)};
}

}  // namespace

PLANECAST_WIDE void find_weights(PlaceLanes& lanes) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Twice the area opposite to each corner, its change by a pixel, over the corner's depth.
    std::array<float, 3> b, bx, by;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t p = k == 2 ? 0 : k + 1;
      const std::size_t q = k == 0 ? 2 : k - 1;
      const float w = lanes.inverse_w[k][i];
      b[k] = (lanes.u[p][i] * lanes.v[q][i] - lanes.u[q][i] * lanes.v[p][i]) * w;
      bx[k] = (lanes.v[p][i] - lanes.v[q][i]) * w;
      by[k] = (lanes.u[q][i] - lanes.u[p][i]) * w;
    }
    const float sum = b[0] + b[1] + b[2];
    const float whole = 1.0F / (sum == 0.0F ? 1e-30F : sum);
    const float sum_x = bx[0] + bx[1] + bx[2];
    const float sum_y = by[0] + by[1] + by[2];
    for (std::size_t k = 0; k < 2; ++k) {
      const float weight = b[k] * whole;
      lanes.weight[k][i] = weight;
      lanes.across[k][i] = (bx[k] - weight * sum_x) * whole;
      lanes.down[k][i] = (by[k] - weight * sum_y) * whole;
    }
  }
}

PLANECAST_WIDE void orient(SurfaceLanes& lanes, const LightUniforms& uniforms) {
  const Vec to_light = vec(uniforms.to_light);
  const glm::mat4 m = uniforms.shadow_from_world;
  const float reach = uniforms.shadow_reach_m;
  const float bias = uniforms.shadow_bias;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Vec g = normalized(load(lanes.normal, i)) * lanes.facing[i];
    const Vec given = load(lanes.tangent, i);
    const Vec across = given - g * dot(g, given);
    const float length2 = dot(across, across);
    const Vec t = across * (lanes.facing[i] / std::sqrt(larger(length2, 1e-30F)));
    const Vec b = cross(g, t) * lanes.handedness[i];
    const Vec bend = load(lanes.bend, i);
    const Vec bent = normalized(t * bend.x + b * bend.y + g * bend.z);
    const bool flat = length2 < 1e-12F;
    const Vec n = {flat ? g.x : bent.x, flat ? g.y : bent.y, flat ? g.z : bent.z};
    store(lanes.geometric, i, g);
    store(lanes.shading, i, n);
    lanes.lit[i] = dot(n, to_light) > 0.0F ? 1.0F : 0.0F;
    const float n_dot_l = larger(dot(g, to_light), 0.0F);
    const float slope = std::sqrt(larger(1.0F - n_dot_l * n_dot_l, 0.0F));
    const Vec p = load(lanes.position, i) + g * (reach * (0.3F + slope));
    const float x = m[0][0] * p.x + m[1][0] * p.y + m[2][0] * p.z + m[3][0];
    const float y = m[0][1] * p.x + m[1][1] * p.y + m[2][1] * p.z + m[3][1];
    const float z = m[0][2] * p.x + m[1][2] * p.y + m[2][2] * p.z + m[3][2];
    store(lanes.shadow_at, i, {0.5F * x + 0.5F, 0.5F * y + 0.5F, z - bias});
  }
}

/// Four comparisons, each blended between the four nearest texels. The map has a border that is
/// lit, wider than the filter; beyond it all is lit.
PLANECAST_WIDE void find_sun(SurfaceLanes& lanes, const ShadowTexels& shadow) {
  const std::int32_t width = shadow.size;
  const auto size = static_cast<float>(width);
  const std::array<float, 4> step_x = {size * shadow.step.x, -size * shadow.step.x,
                                       -size * shadow.step.y, size * shadow.step.y};
  const std::array<float, 4> step_y = {size * shadow.step.y, -size * shadow.step.y,
                                       size * shadow.step.x, -size * shadow.step.x};
  const float reach = larger(std::abs(step_x[0]), std::abs(step_y[0])) + 1.0F;
  const float farthest = size - 1.0F - reach;
  const float* depth = shadow.depth;
  alignas(64) Lane sum{};
  alignas(64) Lane centre_x;
  alignas(64) Lane centre_y;
  alignas(64) Lane compared;
  alignas(64) Lane moved;  // 1 inside the map, 0 where nothing is compared
  alignas(64) Lane right;  // from the left texel to the right one
  alignas(64) Lane down;
  alignas(64) LaneInt at;
  LanePairs<float> upper;
  LanePairs<float> lower;
  std::int32_t any_lit = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float x = size * lanes.shadow_at.x[i] - 0.5F;
    const float y = size * lanes.shadow_at.y[i] - 0.5F;
    const bool inside = (x > reach) & (y > reach) & (x < farthest) & (y < farthest);
    centre_x[i] = inside ? x : 0.0F;
    centre_y[i] = inside ? y : 0.0F;
    moved[i] = inside ? 1.0F : 0.0F;
    compared[i] = inside ? lanes.shadow_at.z[i] : -1.0F;
    any_lit |= lanes.lit[i] > 0.0F ? 1 : 0;
  }
  if (any_lit == 0) return;  // what arrives lights nothing
  for (std::size_t tap = 0; tap < 4; ++tap) {
    const float dx = step_x[tap];
    const float dy = step_y[tap];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float x = centre_x[i] + moved[i] * dx;
      const float y = centre_y[i] + moved[i] * dy;
      const auto x0 = static_cast<std::int32_t>(x);
      const auto y0 = static_cast<std::int32_t>(y);
      right[i] = x - static_cast<float>(x0);
      down[i] = y - static_cast<float>(y0);
      at[i] = y0 * width + x0;
    }
    pick_pairs(depth, at, upper);
    pick_pairs(depth + width, at, lower);
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float z = compared[i];
      const float a = z <= upper.values[2 * i] ? 1.0F : 0.0F;
      const float b = z <= upper.values[2 * i + 1] ? 1.0F : 0.0F;
      const float c = z <= lower.values[2 * i] ? 1.0F : 0.0F;
      const float d = z <= lower.values[2 * i + 1] ? 1.0F : 0.0F;
      const float top = a + right[i] * (b - a);
      const float low = c + right[i] * (d - c);
      sum[i] += top + down[i] * (low - top);
    }
  }
  for (std::size_t i = 0; i < kLanes; ++i) lanes.arrives[i] = 0.25F * sum[i];
}

PLANECAST_WIDE void show_albedo(SurfaceLanes& lanes, float exposure) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Vec albedo = load(lanes.albedo, i);
    store(lanes.color_root, i,
          {root_of_color(albedo.x * exposure), root_of_color(albedo.y * exposure),
           root_of_color(albedo.z * exposure)});
  }
}

namespace {

template <bool kMirrored>
PLANECAST_INLINE void light_lanes(SurfaceLanes& lanes, const LightUniforms& uniforms) {
  const Sh sh = load_sh(uniforms.ambient_sh);
  const Vec eye = vec(uniforms.eye);
  const Vec to_light = vec(uniforms.to_light);
  const Vec sun = vec(uniforms.sun);
  const float exposure = uniforms.exposure;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Vec n = load(lanes.shading, i);
    const Vec v = normalized(eye - load(lanes.position, i));
    const Vec albedo = load(lanes.albedo, i);
    const float metallic = lanes.metallic[i];
    const float roughness = smaller(larger(lanes.roughness[i], kSmallestRoughness), 1.0F);
    const float alpha = roughness * roughness;
    const float n_dot_v = larger(dot(n, v), kSmallestCosine);
    const float dull = 1.0F - metallic;
    const Vec f0 = {kDielectric * dull + albedo.x * metallic,
                    kDielectric * dull + albedo.y * metallic,
                    kDielectric * dull + albedo.z * metallic};
    const Vec diffuse = albedo * dull;
    const Vec reflected = kMirrored ? load(lanes.reflected, i) : reflected_sh(sh, n, v, alpha);
    const Vec ambient = ambient_light(sh, n, reflected, diffuse, f0, roughness, n_dot_v);
    const float n_dot_l = dot(n, to_light);
    const Vec direct =
        sun_light(n, v, to_light, diffuse, f0, alpha, n_dot_v, larger(n_dot_l, 0.0F));
    const Vec color = ambient * lanes.open[i] + direct * sun * (lanes.arrives[i] * lanes.lit[i]) +
                      load(lanes.emissive, i);
    store(lanes.color_root, i,
          {root_of_color(color.x * exposure), root_of_color(color.y * exposure),
           root_of_color(color.z * exposure)});
  }
}

}  // namespace

PLANECAST_WIDE void light(SurfaceLanes& lanes, const LightUniforms& uniforms) {
  light_lanes<false>(lanes, uniforms);
}

PLANECAST_WIDE void light_mirroring(SurfaceLanes& lanes, const LightUniforms& uniforms) {
  light_lanes<true>(lanes, uniforms);
}

}  // namespace planecast::render
