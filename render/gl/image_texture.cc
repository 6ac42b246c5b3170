#include "render/gl/image_texture.h"

#include <algorithm>
#include <array>
#include <bit>

namespace planecast::render {

TextureHandle upload_image(const Gl& gl, const ImageU8& image, const TextureOptions& options) {
  constexpr std::array<GLenum, 4> kFormats = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
  const bool mipmaps = options.min_filter != GL_NEAREST && options.min_filter != GL_LINEAR;
  const auto longest = static_cast<unsigned>(std::max(image.width, image.height));
  const int levels = mipmaps ? std::bit_width(longest) : 1;

  TextureHandle texture(gl);
  const GLuint id = texture.id();
  gl.TextureStorage2D(id, levels, options.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, image.width,
                      image.height);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TextureSubImage2D(id, 0, 0, 0, image.width, image.height,
                       kFormats[static_cast<std::size_t>(std::clamp(image.channels, 1, 4) - 1)],
                       GL_UNSIGNED_BYTE, image.pixels.data());
  gl.TextureParameteri(id, GL_TEXTURE_WRAP_S, options.wrap_s);
  gl.TextureParameteri(id, GL_TEXTURE_WRAP_T, options.wrap_t);
  gl.TextureParameteri(id, GL_TEXTURE_MIN_FILTER, options.min_filter);
  gl.TextureParameteri(id, GL_TEXTURE_MAG_FILTER, options.mag_filter);
  if (mipmaps) gl.GenerateTextureMipmap(id);
  return texture;
}

}  // namespace planecast::render
