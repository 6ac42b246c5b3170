#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/image.h"

namespace planecast::render {

/// IEC 61966-2-1 by tables. Encoding is fine enough that every byte comes back as itself.
class SrgbTables {
 public:
  static const SrgbTables& get();
  float linear(std::uint8_t value) const { return linear_[value]; }
  /// `linear` must lie in 0..1.
  std::uint8_t encode(float linear) const {
    return encoded_[static_cast<std::size_t>(linear * static_cast<float>(encoded_.size() - 1) +
                                             0.5F)];
  }

 private:
  SrgbTables();
  std::array<float, 256> linear_{};
  std::array<std::uint8_t, 65536> encoded_{};
};

/// Half the size, each texel the mean of four. `colors`: channels 0 to 2 are sRGB and averaged in
/// linear light, channel 3 as it is.
ImageU8 halved(const ImageU8& image, bool colors);

/// Levels of a full mip chain for an image of that size.
int mip_level_count(int width, int height);

}  // namespace planecast::render
