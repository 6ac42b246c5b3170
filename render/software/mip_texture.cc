#include "render/software/mip_texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "render/mip_levels.h"

namespace planecast::render {
namespace {

/// Places between texels, and weights, in 1/256.
constexpr int kTexel = 256;
/// A blended byte of four texels is at most 255 of these.
constexpr float kByteScale = 1.0F / (255.0F * 65536.0F);

/// Two neighbouring texels along one axis and how far the place is from the first to the second.
/// Along x the second follows the first in memory.
struct alignas(64) AxisLanes {
  LaneInt first, second, share;
};

struct alignas(64) ColorLanes {
  Lane red, green, blue;
};

/// Into 0..1 by the wrap mode; what is clamped later is only kept from overflowing. What is no
/// number becomes 0.
PLANECAST_INLINE void wrap(const float* u, GLint mode, Lane& out) {
  if (mode == GL_REPEAT) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float share = u[i] - std::floor(u[i]);
      out[i] = share >= 0.0F ? share : 0.0F;
    }
  } else if (mode == GL_MIRRORED_REPEAT) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float half = 0.5F * u[i];
      const float share = std::abs(2.0F * (half - std::floor(half)) - 1.0F);
      out[i] = share >= 0.0F ? 1.0F - share : 0.0F;
    }
  } else {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float limited = u[i] > -1.0F ? u[i] : -1.0F;
      out[i] = limited < 2.0F ? limited : 2.0F;
    }
  }
}

/// `linear` is 1 where neighbours are blended, else 0.
PLANECAST_INLINE void find_neighbours(const Lane& wrapped, const LaneInt& size,
                                      const LaneInt& linear, bool repeat, AxisLanes& out) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    // From a texel's border to its centre it is half a texel.
    const std::int32_t place =
        static_cast<std::int32_t>(wrapped[i] * static_cast<float>(kTexel * size[i])) -
        (kTexel / 2) * linear[i];
    out.first[i] = place >> 8;
    out.share[i] = place & ((kTexel - 1) * linear[i]);
  }
  if (repeat) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::int32_t n = size[i];
      std::int32_t first = out.first[i];
      first = first < 0 ? n - 1 : first;
      first = first >= n ? 0 : first;
      const std::int32_t second = first + 1;
      out.first[i] = first;
      out.second[i] = second >= n ? 0 : second;
    }
  } else {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::int32_t last = size[i] - 1;
      const std::int32_t first = out.first[i];
      const std::int32_t second = first + 1;
      const std::int32_t first_up = first > 0 ? first : 0;
      const std::int32_t second_up = second > 0 ? second : 0;
      out.share[i] = first < 0 ? 0 : out.share[i];  // the first is the second there
      out.first[i] = first_up < last ? first_up : last;
      out.second[i] = second_up < last ? second_up : last;
    }
  }
}

/// The left ones of the four texels around a place.
struct alignas(64) CornerLanes {
  LaneInt top, low;
};

/// Blends four texels of bytes, all in integers: first down, then across. Red and blue share a
/// register on the way, sixteen bits each.
PLANECAST_INLINE void blend_bytes(const std::uint32_t* texels, const CornerLanes& at,
                                  const AxisLanes& x, const AxisLanes& y, ColorLanes& out) {
  constexpr std::uint32_t kRedBlue = 0x00FF00FFU;
  LanePairs<std::uint32_t> top;
  LanePairs<std::uint32_t> low;
  pick_pairs(texels, at.top, top);
  pick_pairs(texels, at.low, low);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::uint32_t a = top.values[2 * i];
    const std::uint32_t b = top.values[2 * i + 1];
    const std::uint32_t c = low.values[2 * i];
    const std::uint32_t d = low.values[2 * i + 1];
    const auto down = static_cast<std::uint32_t>(y.share[i]);
    const auto up = static_cast<std::uint32_t>(kTexel) - down;
    const auto right = static_cast<std::uint32_t>(x.share[i]);
    const auto left = static_cast<std::uint32_t>(kTexel) - right;
    const std::uint32_t left_rb = (a & kRedBlue) * up + (c & kRedBlue) * down;
    const std::uint32_t right_rb = (b & kRedBlue) * up + (d & kRedBlue) * down;
    const std::uint32_t left_g = (a >> 8U & 0xFFU) * up + (c >> 8U & 0xFFU) * down;
    const std::uint32_t right_g = (b >> 8U & 0xFFU) * up + (d >> 8U & 0xFFU) * down;
    const std::uint32_t red = (left_rb & 0xFFFFU) * left + (right_rb & 0xFFFFU) * right;
    const std::uint32_t blue = (left_rb >> 16U) * left + (right_rb >> 16U) * right;
    const std::uint32_t green = left_g * left + right_g * right;
    // Less than 2^24: exact as floats.
    out.red[i] = kByteScale * static_cast<float>(static_cast<std::int32_t>(red));
    out.green[i] = kByteScale * static_cast<float>(static_cast<std::int32_t>(green));
    out.blue[i] = kByteScale * static_cast<float>(static_cast<std::int32_t>(blue));
  }
}

/// `at`: first channels of the texels.
PLANECAST_INLINE void blend_floats(const float* channel, const CornerLanes& at, const AxisLanes& x,
                                   const AxisLanes& y, Lane& out) {
  constexpr float kShare = 1.0F / static_cast<float>(kTexel);
  Lane top_left;
  Lane top_right;
  Lane low_left;
  Lane low_right;
  pick(channel, at.top, top_left);
  pick(channel + 4, at.top, top_right);
  pick(channel, at.low, low_left);
  pick(channel + 4, at.low, low_right);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float fx = kShare * static_cast<float>(x.share[i]);
    const float fy = kShare * static_cast<float>(y.share[i]);
    const float top = top_left[i] + fx * (top_right[i] - top_left[i]);
    const float low = low_left[i] + fx * (low_right[i] - low_left[i]);
    out[i] = top + fy * (low - top);
  }
}

PLANECAST_INLINE void read_level(const TexelLevels& texture, const LaneInt& level,
                                 const LaneInt& linear, const Lane& u, const Lane& v,
                                 ColorLanes& out) {
  LaneInt width;
  LaneInt height;
  LaneInt first;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::int32_t w = texture.width >> level[i];
    const std::int32_t h = texture.height >> level[i];
    width[i] = w > 1 ? w : 1;
    height[i] = h > 1 ? h : 1;
    first[i] = texture.first[static_cast<std::size_t>(level[i])];
  }
  AxisLanes x;
  AxisLanes y;
  find_neighbours(u, width, linear, texture.wrap_s == GL_REPEAT, x);
  find_neighbours(v, height, linear, texture.wrap_t == GL_REPEAT, y);
  CornerLanes at;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::int32_t stride = width[i] + 1;
    at.top[i] = first[i] + y.first[i] * stride + x.first[i];
    at.low[i] = first[i] + y.second[i] * stride + x.first[i];
  }
  if (texture.floats.empty()) {
    blend_bytes(texture.bytes.data(), at, x, y, out);
    return;
  }
  const float* floats = &texture.floats.front().x;
  for (LaneInt* corner : {&at.top, &at.low}) {
    for (std::size_t i = 0; i < kLanes; ++i) (*corner)[i] *= 4;
  }
  blend_floats(floats, at, x, y, out.red);
  blend_floats(floats + 1, at, x, y, out.green);
  blend_floats(floats + 2, at, x, y, out.blue);
}

ImageU8 with_four_channels(const ImageU8& image) {
  ImageU8 four(image.width, image.height, 4);
  const auto channels = static_cast<std::size_t>(image.channels);
  for (std::size_t i = 0; i < four.pixels.size() / 4; ++i) {
    for (std::size_t c = 0; c < 4; ++c) {
      const std::uint8_t missing = c == 3 ? 255 : 0;
      four.pixels[4 * i + c] = c < channels ? image.pixels[channels * i + c] : missing;
    }
  }
  return four;
}

bool is_mipmapped(GLint filter) { return filter != GL_NEAREST && filter != GL_LINEAR; }

TexelLevels no_levels(const MipTexture::Options& options) {
  TexelLevels texels;
  texels.wrap_s = options.wrap_s;
  texels.wrap_t = options.wrap_t;
  texels.linear_min = options.min_filter == GL_LINEAR ||
                      options.min_filter == GL_LINEAR_MIPMAP_NEAREST ||
                      options.min_filter == GL_LINEAR_MIPMAP_LINEAR;
  texels.linear_mag = options.mag_filter != GL_NEAREST;
  texels.between_levels = options.min_filter == GL_NEAREST_MIPMAP_LINEAR ||
                          options.min_filter == GL_LINEAR_MIPMAP_LINEAR;
  return texels;
}

}  // namespace

PLANECAST_WIDE void read_lanes(const TexelLevels& texture, const float* u, const float* v,
                               const float* level, float* red, float* green, float* blue) {
  LaneInt finer;
  LaneInt coarser;
  LaneInt linear;
  Lane share;
  const std::int32_t last = texture.count - 1;
  const auto farthest = static_cast<float>(last);
  const std::int32_t linear_min = texture.linear_min ? 1 : 0;
  const std::int32_t linear_mag = texture.linear_mag ? 1 : 0;
  // Where one level is nearest, half a level more makes it the lower whole number.
  const float rounding = texture.between_levels ? 0.0F : 0.5F;
  const float blended = texture.between_levels ? 1.0F : 0.0F;
  std::int32_t any_blended = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const bool smaller_than_pixels = level[i] > 0.0F;
    const float positive = smaller_than_pixels ? level[i] : 0.0F;
    const float place = positive < farthest ? positive : farthest;
    const auto whole = static_cast<std::int32_t>(place + (smaller_than_pixels ? rounding : 0.0F));
    finer[i] = whole < last ? whole : last;
    coarser[i] = whole < last ? whole + 1 : last;
    const float rest = blended * (place - static_cast<float>(whole));
    constexpr float kInvisible = 1.0F / 512.0F;
    share[i] = rest < kInvisible ? 0.0F : rest;
    any_blended |= share[i] > 0.0F ? 1 : 0;
    linear[i] = smaller_than_pixels ? linear_min : linear_mag;
  }
  Lane wrapped_u;
  Lane wrapped_v;
  wrap(u, texture.wrap_s, wrapped_u);
  wrap(v, texture.wrap_t, wrapped_v);
  ColorLanes near;
  read_level(texture, finer, linear, wrapped_u, wrapped_v, near);
  ColorLanes far = near;
  if (any_blended != 0) read_level(texture, coarser, linear, wrapped_u, wrapped_v, far);
  for (std::size_t i = 0; i < kLanes; ++i) {
    red[i] = near.red[i] + share[i] * (far.red[i] - near.red[i]);
    green[i] = near.green[i] + share[i] * (far.green[i] - near.green[i]);
    blue[i] = near.blue[i] + share[i] * (far.blue[i] - near.blue[i]);
  }
}

MipTexture::MipTexture(const ImageU8& image, const Options& options) : texels_(no_levels(options)) {
  ImageU8 level = with_four_channels(image);
  const int count =
      is_mipmapped(options.min_filter) ? mip_level_count(image.width, image.height) : 1;
  reserve(image, count, options.decode);
  for (int i = 0; i < count; ++i) {
    add_level(level, options.decode);
    level = halved(level, options.colors);
  }
}

MipTexture::MipTexture(const std::vector<ImageU8>& levels, const Options& options)
    : texels_(no_levels(options)) {
  if (levels.empty()) return;
  reserve(levels.front(), static_cast<int>(levels.size()), options.decode);
  for (const ImageU8& level : levels) add_level(level, options.decode);
}

void MipTexture::add_level(const ImageU8& image, bool decode) {
  if (texels_.count == static_cast<int>(TexelLevels::kMostLevels)) return;
  if (texels_.count == 0) {
    texels_.width = image.width;
    texels_.height = image.height;
  }
  const std::size_t before = decode ? texels_.floats.size() : texels_.bytes.size();
  texels_.first[static_cast<std::size_t>(texels_.count++)] = static_cast<std::int32_t>(before);
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  const std::size_t follows = texels_.wrap_s == GL_REPEAT ? 0 : width - 1;
  const std::size_t after = before + (width + 1) * height;
  if (decode) {
    texels_.floats.resize(after);
  } else {
    texels_.bytes.resize(after);
  }
  const SrgbTables& tables = SrgbTables::get();
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* row = &image.pixels[4 * y * width];
    const std::size_t first = before + y * (width + 1);
    if (decode) {
      glm::vec4* out = &texels_.floats[first];
      for (std::size_t x = 0; x < width; ++x) {
        const std::uint8_t* rgba = row + 4 * x;
        out[x] = {tables.linear(rgba[0]), tables.linear(rgba[1]), tables.linear(rgba[2]),
                  static_cast<float>(rgba[3]) / 255.0F};
      }
      out[width] = out[follows];
    } else {
      std::memcpy(&texels_.bytes[first], row, 4 * width);
      texels_.bytes[first + width] = texels_.bytes[first + follows];
    }
  }
}

void MipTexture::reserve(const ImageU8& image, int levels, bool decode) {
  std::size_t texels = 0;
  for (int i = 0; i < levels; ++i) {
    texels += static_cast<std::size_t>(std::max(image.width >> i, 1) + 1) *
              static_cast<std::size_t>(std::max(image.height >> i, 1));
  }
  if (decode) {
    texels_.floats.reserve(texels);
  } else {
    texels_.bytes.reserve(texels);
  }
}

void MipTexture::read(TextureReads& reads) const {
  for (std::size_t i = 0; i < reads.count; i += kLanes) {
    read_lanes(texels_, &reads.u[i], &reads.v[i], &reads.level[i], &reads.red[i], &reads.green[i],
               &reads.blue[i]);
  }
}

glm::vec3 MipTexture::sample(glm::vec2 uv, float level) const {
  TextureReads reads;
  reads.count = 1;
  reads.u[0] = uv.x;
  reads.v[0] = uv.y;
  reads.level[0] = level;
  read(reads);
  return {reads.red[0], reads.green[0], reads.blue[0]};
}

}  // namespace planecast::render
