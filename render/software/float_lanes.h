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
  LaneInt top_left;
  LaneInt top_right;
  LaneInt low_left;
  LaneInt low_right;
  Lane right;
  Lane down;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto last_x = static_cast<float>(width[i] - 1);
    const auto last_y = static_cast<float>(height[i] - 1);
    // What is no number becomes 0.
    const float inside_x = smaller(x[i] > 0.0F ? x[i] : 0.0F, last_x);
    const float inside_y = smaller(y[i] > 0.0F ? y[i] : 0.0F, last_y);
    const auto x0 = static_cast<std::int32_t>(inside_x);
    const auto y0 = static_cast<std::int32_t>(inside_y);
    right[i] = inside_x - static_cast<float>(x0);
    down[i] = inside_y - static_cast<float>(y0);
    const std::int32_t step_x = x0 + 1 < width[i] ? 1 : 0;
    const std::int32_t step_y = y0 + 1 < height[i] ? width[i] : 0;
    const std::int32_t at = first[i] + y0 * width[i] + x0;
    top_left[i] = at;
    top_right[i] = at + step_x;
    low_left[i] = at + step_y;
    low_right[i] = at + step_y + step_x;
  }
  Lane a;
  Lane b;
  Lane c;
  Lane d;
  pick(texels, top_left, a);
  pick(texels, top_right, b);
  pick(texels, low_left, c);
  pick(texels, low_right, d);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float top = a[i] + right[i] * (b[i] - a[i]);
    const float low = c[i] + right[i] * (d[i] - c[i]);
    out[i] = top + down[i] * (low - top);
  }
}

}  // namespace planecast::render
