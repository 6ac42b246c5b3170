#pragma once

#include "render/gl/objects.h"
#include "render/image.h"

namespace planecast::render {

struct TextureOptions {
  bool srgb = false;  ///< decode to linear when sampled
  GLint wrap_s = GL_REPEAT;
  GLint wrap_t = GL_REPEAT;
  GLint min_filter = GL_LINEAR_MIPMAP_LINEAR;
  GLint mag_filter = GL_LINEAR;
};

/// Colours that are stored encoded and decoded by the shader, after filtering within a level: plain
/// bytes are filtered several times faster. The levels themselves are averaged in linear light.
bool better_encoded(const ImageU8& image);
TextureHandle upload_encoded(const Gl& gl, const ImageU8& image, const TextureOptions& options);

/// Uploads 1 to 4 channels with the mip levels the filter needs. Row 0 of the image is at v = 0.
TextureHandle upload_image(const Gl& gl, const ImageU8& image, const TextureOptions& options);

}  // namespace planecast::render
