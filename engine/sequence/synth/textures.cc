#include "engine/sequence/synth/textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "engine/sequence/synth/noise.h"

namespace planecast::engine::synth {

namespace {

float smooth_step(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

Color blend(const Color& a, const Color& b, float t) { return a + (b - a) * t; }

int cell(float x) { return static_cast<int>(std::floor(x)); }

/// Distance in metres to the nearer end of a cell of the given size.
float edge_distance(float x, float size) {
  const float t = x - std::floor(x / size) * size;
  return std::min(t, size - t);
}

float linear_from_srgb(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = linear_from_srgb(static_cast<float>(i) / 255.0F);
    }
    return values;
  }();
  return table;
}

Color texel(const cv::Mat& bgr, int x, int y) {
  const auto& p = bgr.at<cv::Vec3b>(std::clamp(y, 0, bgr.rows - 1), std::clamp(x, 0, bgr.cols - 1));
  const auto& linear = linear_table();
  return {linear[p[2]], linear[p[1]], linear[p[0]]};
}

}  // namespace

Color color_from_srgb(std::uint32_t rgb) {
  const auto& linear = linear_table();
  return {linear[rgb >> 16 & 0xFF], linear[rgb >> 8 & 0xFF], linear[rgb & 0xFF]};
}

Texture plain(const Color& color) {
  return [color](float, float) { return color; };
}

Texture plaster(const Color& base, std::uint32_t seed) {
  return [base, seed](float u, float v) -> Color {
    const float clouds = 0.030F * fractal_noise(1.3F * u, 1.3F * v, 3, seed);
    const float roller = 0.020F * smooth_noise(9.0F * u, 1.5F * v, seed + 1);
    const float grain = 0.055F * fractal_noise(140.0F * u, 140.0F * v, 2, seed + 2);
    return base * (1.0F + clouds + roller + grain);
  };
}

Texture wood(const WoodOptions& o, std::uint32_t seed) {
  return [o, seed](float u, float v) -> Color {
    const int row = cell(v / o.board_width_m);
    const float shifted = u + cell_random(row, 7, seed) * o.board_length_m;
    const int board = cell(shifted / o.board_length_m);
    const std::uint32_t own = seed + 31U * static_cast<std::uint32_t>(row * 57 + board * 13);
    const float tone = o.variation * (cell_random(row, board, seed + 3) - 0.5F);
    // Year rings: a few wide bands along the board, bent by slow noise, with fine pores on top.
    const float bend = fractal_noise(1.1F * u, 5.0F * v, 3, own);
    const float rings = 0.5F + 0.5F * std::sin(55.0F * v + 9.0F * bend);
    const float pores = fractal_noise(9.0F * u, 330.0F * v, 2, own + 5);
    const float fine = fractal_noise(40.0F * u, 900.0F * v, 1, own + 9);
    const float share = std::clamp(0.15F + 0.55F * rings * rings + 0.45F * pores, 0.0F, 1.0F);
    Color color = blend(o.light, o.dark, share) * (1.0F + tone + 0.18F * fine);
    if (o.gap_m > 0.0F) {
      const float side = edge_distance(v, o.board_width_m);
      const float end = edge_distance(shifted, o.board_length_m);
      color *= 0.35F + 0.65F * smooth_step(0.0F, o.gap_m, std::min(side, end));
    }
    return color;
  };
}

Texture tiles(const Color& tile, const Color& grout, float size_m, std::uint32_t seed) {
  return [=](float u, float v) -> Color {
    const int column = cell(u / size_m);
    const int row = cell(v / size_m);
    const std::uint32_t own = seed + static_cast<std::uint32_t>(column * 71 + row * 173);
    const float tone = 0.14F * (cell_random(column, row, seed) - 0.5F);
    const float marble = 0.16F * fractal_noise(9.0F * u, 9.0F * v, 4, own);
    const float speckle = smooth_noise(300.0F * u, 300.0F * v, own + 1) > 0.72F ? -0.22F : 0.0F;
    const float edge = std::min(edge_distance(u, size_m), edge_distance(v, size_m));
    const Color joint = grout * (1.0F + 0.15F * smooth_noise(200.0F * u, 200.0F * v, seed));
    return blend(joint, tile * (1.0F + tone + marble + speckle),
                 smooth_step(0.0022F, 0.0040F, edge));
  };
}

Texture bricks(const Color& brick, const Color& mortar, std::uint32_t seed) {
  return [=](float u, float v) -> Color {
    constexpr float kLength = 0.25F;
    constexpr float kHeight = 0.0775F;
    const int row = cell(v / kHeight);
    const float shifted = u + (row % 2 != 0 ? 0.5F * kLength : 0.0F);
    const int column = cell(shifted / kLength);
    const std::uint32_t own = seed + static_cast<std::uint32_t>(column * 97 + row * 31);
    const float tone = 0.5F * (cell_random(column, row, seed) - 0.5F);
    const float warm = 0.15F * (cell_random(column, row, seed + 1) - 0.5F);
    const float rough = 0.30F * fractal_noise(45.0F * u, 45.0F * v, 4, own);
    const float wobble = 0.003F * smooth_noise(30.0F * u, 30.0F * v, seed + 2);
    const float edge =
        std::min(edge_distance(shifted, kLength), edge_distance(v, kHeight)) + wobble;
    const Color face =
        (brick * (1.0F + tone + rough)).cwiseProduct(Color(1.0F + warm, 1.0F, 1.0F - warm));
    const Color joint = mortar * (1.0F + 0.2F * fractal_noise(120.0F * u, 120.0F * v, 2, seed));
    return blend(joint, face, smooth_step(0.004F, 0.007F, edge)).cwiseMax(0.01F);
  };
}

Texture carpet(const Color& base, const Color& fleck, std::uint32_t seed) {
  return [=](float u, float v) -> Color {
    const float fibre = 0.45F * fractal_noise(260.0F * u, 260.0F * v, 2, seed);
    const float worn = 0.12F * fractal_noise(2.0F * u, 2.0F * v, 3, seed + 1);
    const float spot = smooth_step(0.35F, 0.6F, smooth_noise(70.0F * u, 70.0F * v, seed + 2));
    return blend(base, fleck, 0.6F * spot) * (1.0F + fibre + worn);
  };
}

Texture fabric(const Color& base, std::uint32_t seed) {
  return [=](float u, float v) -> Color {
    constexpr float kThreads = 260.0F;  // a metre
    const float warp = std::sin(6.2831853F * kThreads * u);
    const float weft = std::sin(6.2831853F * kThreads * v);
    const float slub = fractal_noise(12.0F * u, 160.0F * v, 2, seed) +
                       fractal_noise(160.0F * u, 12.0F * v, 2, seed + 1);
    const float cloud = fractal_noise(6.0F * u, 6.0F * v, 3, seed + 2);
    return base * (1.0F + 0.07F * warp * weft + 0.22F * slub + 0.10F * cloud);
  };
}

Texture mottled(const Color& a, const Color& b, float size_m, std::uint32_t seed) {
  return [=](float u, float v) -> Color {
    const float share = 0.5F + 0.9F * fractal_noise(u / size_m, v / size_m, 4, seed);
    return blend(a, b, std::clamp(share, 0.0F, 1.0F));
  };
}

Texture rug(float width_m, float height_m, std::uint32_t seed) {
  static constexpr std::uint32_t kGrounds[] = {0x8E3B2F, 0x2F4858, 0x7A5C3E};
  static constexpr std::uint32_t kSeconds[] = {0xE3CFA4, 0xE8D8B8, 0xEADBC0};
  static constexpr std::uint32_t kThirds[] = {0x27415C, 0xB5553C, 0x31524A};
  const Color ground = color_from_srgb(kGrounds[seed % 3]);
  const Color second = color_from_srgb(kSeconds[seed % 3]);
  const Color third = color_from_srgb(kThirds[seed % 3]);
  return [=](float u, float v) -> Color {
    const float rim = std::min({u, v, width_m - u, height_m - v});
    Color color = ground;
    if (rim < 0.03F) {
      color = third;
    } else if (rim < 0.05F || (rim > 0.15F && rim < 0.165F)) {
      color = second;
    } else if (rim <= 0.15F) {  // border of small diamonds
      const float a = std::abs(edge_distance(u, 0.10F) - 0.025F);
      const float b = std::abs(edge_distance(v, 0.10F) - 0.025F);
      color = a + b < 0.022F ? second : third;
    } else {  // rows of stepped medallions
      const float period = 0.34F;
      const float s = std::abs(edge_distance(u, period) - 0.5F * period);
      const float t = std::abs(edge_distance(v, period) - 0.5F * period);
      const float stepped = std::floor((s + t) / 0.02F) * 0.02F;
      if (stepped < 0.04F) {
        color = second;
      } else if (stepped < 0.08F) {
        color = third;
      } else if (stepped < 0.10F) {
        color = second;
      } else if (s > 0.12F && t > 0.12F) {
        color = third;
      }
    }
    const float weave = 0.10F * std::sin(900.0F * v) * std::sin(900.0F * u) +
                        0.32F * fractal_noise(60.0F * u, 220.0F * v, 2, seed);
    const float worn = 0.18F * fractal_noise(3.0F * u, 3.0F * v, 3, seed + 4);
    return color * (1.0F + weave + worn);
  };
}

Texture picture(const cv::Mat& bgr, float width_m, float height_m) {
  const auto image = std::make_shared<cv::Mat>(bgr);
  return [image, width_m, height_m](float u, float v) -> Color {
    const float x = u / width_m * static_cast<float>(image->cols) - 0.5F;
    const float y = (1.0F - v / height_m) * static_cast<float>(image->rows) - 0.5F;
    const int ix = cell(x);
    const int iy = cell(y);
    const float tx = x - static_cast<float>(ix);
    const float ty = y - static_cast<float>(iy);
    const Color top = blend(texel(*image, ix, iy), texel(*image, ix + 1, iy), tx);
    const Color bottom = blend(texel(*image, ix, iy + 1), texel(*image, ix + 1, iy + 1), tx);
    return blend(top, bottom, ty);
  };
}

Texture with_decals(Texture base, std::vector<Decal> decals) {
  return [base = std::move(base), decals = std::move(decals)](float u, float v) -> Color {
    float shade = 1.0F;
    for (auto decal = decals.rbegin(); decal != decals.rend(); ++decal) {
      const float half_u = 0.5F * decal->width_m;
      const float half_v = 0.5F * decal->height_m;
      const float du = u - decal->u_m - half_u;
      const float dv = v - decal->v_m - half_v;
      const float c = std::cos(decal->yaw);
      const float s = std::sin(decal->yaw);
      const float a = c * du + s * dv;
      const float b = -s * du + c * dv;
      const float outside = std::max(std::abs(a) - half_u, std::abs(b) - half_v);
      if (outside <= 0.0F) return shade * decal->texture(a + half_u, b + half_v);
      if (outside < decal->shadow_m) {
        shade *= 0.55F + 0.45F * smooth_step(0.0F, decal->shadow_m, outside);
      }
    }
    return shade * base(u, v);
  };
}

}  // namespace planecast::engine::synth
