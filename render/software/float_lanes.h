#pragma once

#include <algorithm>
#include <cmath>

#include "render/image.h"
#include "render/software/lanes.h"

namespace planecast::render {

/// Reads an image of one float channel at kLanes places, blended between the four nearest texels
/// and clamped to the edge; place (0, 0) is the centre of the first texel. `first` is the texel
/// where each lane's image begins in `texels`, `width` and `height` are its size.
PLANECAST_INLINE void blend_clamped(const float* texels, const LaneInt& first, const LaneInt& width,
                                    const LaneInt& height, const Lane& x, const Lane& y,
                                    Lane& out) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto last_x = static_cast<float>(width[i] - 1);
    const auto last_y = static_cast<float>(height[i] - 1);
    // What is no number becomes 0.
    const float inside_x = smaller(x[i] > 0.0F ? x[i] : 0.0F, last_x);
    const float inside_y = smaller(y[i] > 0.0F ? y[i] : 0.0F, last_y);
    const auto x0 = static_cast<std::int32_t>(inside_x);
    const auto y0 = static_cast<std::int32_t>(inside_y);
    const float fx = inside_x - static_cast<float>(x0);
    const float fy = inside_y - static_cast<float>(y0);
    const std::int32_t right = x0 + 1 < width[i] ? 1 : 0;
    const std::int32_t down = y0 + 1 < height[i] ? width[i] : 0;
    const std::int32_t at = first[i] + y0 * width[i] + x0;
    const float a = texels[at];
    const float b = texels[at + right];
    const float c = texels[at + down];
    const float d = texels[at + down + right];
    const float top = a + fx * (b - a);
    const float low = c + fx * (d - c);
    out[i] = top + fy * (low - top);
  }
}

}  // namespace planecast::render
