#pragma once

#include <cstdint>

namespace planecast::engine::synth {

/// Uniform in [0, 1), a function of the cell alone.
float cell_random(int x, int y, std::uint32_t seed);

/// Smooth random function of the plane in [-1, 1], about one feature a unit (value noise with a
/// quintic fade).
float smooth_noise(float x, float y, std::uint32_t seed);

/// Sum of `octaves` of it, each of twice the frequency and half the height; about [-1, 1].
float fractal_noise(float x, float y, int octaves, std::uint32_t seed);

}  // namespace planecast::engine::synth
