#include "render/gl/image_texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace planecast::render {
namespace {

/// From this side on, texels are hardly ever larger than pixels, so that it does not show whether
/// they are blended encoded or linear.
constexpr int kSmallestEncodedSide = 512;

float decoded(std::uint8_t value) {
  const float c = static_cast<float>(value) / 255.0F;
  return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

std::uint8_t encoded(float linear) {
  const float c =
      linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(c, 0.0F, 1.0F)));
}

/// Encoding by table; fine enough that every byte comes back as itself.
class SrgbTables {
 public:
  SrgbTables() {
    for (int i = 0; i < 256; ++i) {
      linear_[static_cast<std::size_t>(i)] = decoded(static_cast<std::uint8_t>(i));
    }
    for (std::size_t i = 0; i < encoded_.size(); ++i) {
      encoded_[i] = encoded(static_cast<float>(i) / static_cast<float>(encoded_.size() - 1));
    }
  }
  float linear(std::uint8_t value) const { return linear_[value]; }
  std::uint8_t encode(float linear) const {
    return encoded_[static_cast<std::size_t>(linear * static_cast<float>(encoded_.size() - 1) +
                                             0.5F)];
  }

 private:
  std::array<float, 256> linear_{};
  std::array<std::uint8_t, 65536> encoded_{};
};

/// Half the size; colours averaged in linear light, alpha (channel 3) as it is.
ImageU8 halved(const ImageU8& image) {
  static const SrgbTables kTables;
  ImageU8 half(std::max(1, image.width / 2), std::max(1, image.height / 2), image.channels);
  const auto at = [&image](int x, int y, int c) {
    return image.pixels[static_cast<std::size_t>(
        (std::min(y, image.height - 1) * image.width + std::min(x, image.width - 1)) *
            image.channels +
        c)];
  };
  std::size_t next = 0;
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      for (int c = 0; c < half.channels; ++c) {
        const std::array<std::uint8_t, 4> four = {at(2 * x, 2 * y, c), at(2 * x + 1, 2 * y, c),
                                                  at(2 * x, 2 * y + 1, c),
                                                  at(2 * x + 1, 2 * y + 1, c)};
        if (c == 3) {
          half.pixels[next++] =
              static_cast<std::uint8_t>((four[0] + four[1] + four[2] + four[3] + 2) / 4);
          continue;
        }
        float sum = 0.0F;
        for (const std::uint8_t value : four) sum += kTables.linear(value);
        half.pixels[next++] = kTables.encode(0.25F * sum);
      }
    }
  }
  return half;
}

constexpr std::array<GLenum, 4> kFormats = {GL_RED, GL_RG, GL_RGB, GL_RGBA};

void upload_level(const Gl& gl, GLuint texture, int level, const ImageU8& image) {
  gl.TextureSubImage2D(texture, level, 0, 0, image.width, image.height,
                       kFormats[static_cast<std::size_t>(std::clamp(image.channels, 1, 4) - 1)],
                       GL_UNSIGNED_BYTE, image.pixels.data());
}

void set_sampling(const Gl& gl, GLuint texture, const TextureOptions& options) {
  gl.TextureParameteri(texture, GL_TEXTURE_WRAP_S, options.wrap_s);
  gl.TextureParameteri(texture, GL_TEXTURE_WRAP_T, options.wrap_t);
  gl.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, options.min_filter);
  gl.TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, options.mag_filter);
}

int level_count(const ImageU8& image, const TextureOptions& options) {
  const bool mipmaps = options.min_filter != GL_NEAREST && options.min_filter != GL_LINEAR;
  return mipmaps ? std::bit_width(static_cast<unsigned>(std::max(image.width, image.height))) : 1;
}

}  // namespace

bool better_encoded(const ImageU8& image) {
  return std::min(image.width, image.height) >= kSmallestEncodedSide;
}

TextureHandle upload_encoded(const Gl& gl, const ImageU8& image, const TextureOptions& options) {
  const int levels = level_count(image, options);
  TextureHandle texture(gl);
  gl.TextureStorage2D(texture.id(), levels, GL_RGBA8, image.width, image.height);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  upload_level(gl, texture.id(), 0, image);
  ImageU8 smaller = levels > 1 ? halved(image) : ImageU8();
  for (int level = 1; level < levels; ++level) {
    upload_level(gl, texture.id(), level, smaller);
    smaller = halved(smaller);
  }
  set_sampling(gl, texture.id(), options);
  return texture;
}

TextureHandle upload_image(const Gl& gl, const ImageU8& image, const TextureOptions& options) {
  const int levels = level_count(image, options);
  TextureHandle texture(gl);
  const GLuint id = texture.id();
  gl.TextureStorage2D(id, levels, options.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, image.width,
                      image.height);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  upload_level(gl, id, 0, image);
  set_sampling(gl, id, options);
  if (levels > 1) gl.GenerateTextureMipmap(id);
  return texture;
}

}  // namespace planecast::render
