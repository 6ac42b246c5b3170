#include "engine/sequence/synth/noise.h"

#include <cmath>

namespace planecast::engine::synth {

namespace {

std::uint32_t cell_hash(int x, int y, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8DA6B343U ^
                    static_cast<std::uint32_t>(y) * 0xD8163841U ^ seed * 0xCB1AB31FU;
  h = (h ^ (h >> 16)) * 0x85EBCA6BU;
  h = (h ^ (h >> 13)) * 0xC2B2AE35U;
  return h ^ (h >> 16);
}

float fade(float t) { return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F); }

float mix(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace

float cell_random(int x, int y, std::uint32_t seed) {
  return static_cast<float>(cell_hash(x, y, seed) >> 8) * 0x1.0p-24F;
}

float smooth_noise(float x, float y, std::uint32_t seed) {
  const float floor_x = std::floor(x);
  const float floor_y = std::floor(y);
  const int ix = static_cast<int>(floor_x);
  const int iy = static_cast<int>(floor_y);
  const float tx = fade(x - floor_x);
  const float ty = fade(y - floor_y);
  const float low = mix(cell_random(ix, iy, seed), cell_random(ix + 1, iy, seed), tx);
  const float high = mix(cell_random(ix, iy + 1, seed), cell_random(ix + 1, iy + 1, seed), tx);
  return 2.0F * mix(low, high, ty) - 1.0F;
}

float fractal_noise(float x, float y, int octaves, std::uint32_t seed) {
  float sum = 0.0F;
  float height = 0.5F;
  for (int i = 0; i < octaves; ++i) {
    sum += height * smooth_noise(x, y, seed + static_cast<std::uint32_t>(i) * 101U);
    x = 2.0F * x + 17.3F;
    y = 2.0F * y - 9.1F;
    height *= 0.5F;
  }
  return sum;
}

}  // namespace planecast::engine::synth
