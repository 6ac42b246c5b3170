#include "render/gl/image_texture.h"

#include <algorithm>
#include <array>

#include "render/mip_levels.h"

namespace planecast::render {
namespace {

/// From this side on, texels are hardly ever larger than pixels, so that it does not show whether
/// they are blended encoded or linear.
constexpr int kSmallestEncodedSide = 512;

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
  return mipmaps ? mip_level_count(image.width, image.height) : 1;
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
  ImageU8 smaller = levels > 1 ? halved(image, true) : ImageU8();
  for (int level = 1; level < levels; ++level) {
    upload_level(gl, texture.id(), level, smaller);
    smaller = halved(smaller, true);
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
