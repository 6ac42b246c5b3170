#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace planecast::render {

/// Rows of interleaved channels, top row first.
template <typename T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<T> pixels;

  Image() = default;
  Image(int w, int h, int c)
      : width(w),
        height(h),
        channels(c),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) *
               static_cast<std::size_t>(c)) {}
  bool empty() const { return pixels.empty(); }
};

using ImageU8 = Image<std::uint8_t>;
using ImageF = Image<float>;

}  // namespace planecast::render
