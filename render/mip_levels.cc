#include "render/mip_levels.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace planecast::render {
namespace {

float decoded(std::uint8_t value) {
  const float c = static_cast<float>(value) / 255.0F;
  return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

std::uint8_t encoded(float linear) {
  const float c =
      linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(c, 0.0F, 1.0F)));
}

}  // namespace

SrgbTables::SrgbTables() {
  for (int i = 0; i < 256; ++i) {
    linear_[static_cast<std::size_t>(i)] = decoded(static_cast<std::uint8_t>(i));
  }
  for (std::size_t i = 0; i < encoded_.size(); ++i) {
    encoded_[i] = encoded(static_cast<float>(i) / static_cast<float>(encoded_.size() - 1));
  }
}

const SrgbTables& SrgbTables::get() {
  static const SrgbTables kTables;
  return kTables;
}

ImageU8 halved(const ImageU8& image, bool colors) {
  const SrgbTables& tables = SrgbTables::get();
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
        if (c == 3 || !colors) {
          half.pixels[next++] =
              static_cast<std::uint8_t>((four[0] + four[1] + four[2] + four[3] + 2) / 4);
          continue;
        }
        float sum = 0.0F;
        for (const std::uint8_t value : four) sum += tables.linear(value);
        half.pixels[next++] = tables.encode(0.25F * sum);
      }
    }
  }
  return half;
}

int mip_level_count(int width, int height) {
  return std::bit_width(static_cast<unsigned>(std::max(width, height)));
}

}  // namespace planecast::render
