#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/gl/functions.h"
#include "render/image.h"
#include "render/software/lanes.h"

namespace planecast::render {

/// Places of one texture that are read together, and what is found there.
struct alignas(64) TextureReads {
  /// Eight taps for each lane.
  static constexpr std::size_t kMost = 8 * kLanes;
  std::size_t count = 0;
  std::array<float, kMost> u{}, v{};
  std::array<float, kMost> level{};  ///< 0 full size, each further one half of it
  std::array<float, kMost> red{}, green{}, blue{};
};

/// Levels of a texture in memory and how they are read. Each level is half of the one before,
/// rounded down, at least 1. A row is followed by the texel that comes after its last by the wrap
/// mode, so that neighbours lie side by side.
struct TexelLevels {
  static constexpr std::size_t kMostLevels = 16;
  int width = 0;
  int height = 0;
  int count = 0;
  std::array<std::int32_t, kMostLevels> first{};  ///< texel of each level
  std::vector<std::uint32_t> bytes;               ///< RGBA
  std::vector<glm::vec4> floats;                  ///< instead of bytes
  GLint wrap_s = GL_REPEAT;
  GLint wrap_t = GL_REPEAT;
  bool linear_min = true;
  bool linear_mag = true;
  bool between_levels = true;  ///< two levels are blended
};
/// Colours at kLanes places; see MipTexture::read.
void read_lanes(const TexelLevels& texture, const float* u, const float* v, const float* level,
                float* red, float* green, float* blue);

/// A mip-mapped texture read by the processor, filtered as OpenGL does. Texels are kept as bytes
/// or, where colours are to be decoded before they are blended, as linear floats.
class MipTexture {
 public:
  /// Filters and wraps are OpenGL's numbers.
  struct Options {
    GLint wrap_s = GL_REPEAT;
    GLint wrap_t = GL_REPEAT;
    GLint min_filter = GL_LINEAR_MIPMAP_LINEAR;
    GLint mag_filter = GL_LINEAR;
    bool colors = false;  ///< levels are averaged in linear light
    bool decode = false;  ///< texels are decoded from sRGB before they are blended
  };

  MipTexture() = default;
  MipTexture(const ImageU8& image, const Options& options);
  /// From finished levels of four channels, each half of the one before.
  MipTexture(const std::vector<ImageU8>& levels, const Options& options);

  glm::vec2 size() const {
    return {static_cast<float>(texels_.width), static_cast<float>(texels_.height)};
  }
  /// Red, green and blue, 0..1, of all the places. Any place and level may be asked for.
  void read(TextureReads& reads) const;
  glm::vec3 sample(glm::vec2 uv, float level) const;

 private:
  /// Memory for `levels` levels, of which `image` is the first.
  void reserve(const ImageU8& image, int levels, bool decode);
  void add_level(const ImageU8& image, bool decode);

  TexelLevels texels_;
};

}  // namespace planecast::render
