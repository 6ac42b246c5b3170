#include "engine/output/palette.h"

#include <algorithm>
#include <cmath>

namespace planecast::engine {

Rgb plane_color(int plane_id) {
  if (plane_id < 0) return kNoPlaneColor;
  // Steps of the golden ratio spread any number of hues evenly round the circle.
  constexpr double kGoldenRatio = 0.6180339887498949;
  const double hue = 6.0 * std::fmod(0.58 + plane_id * kGoldenRatio, 1.0);
  const double value = plane_id % 3 == 1 ? 0.75 : 0.95;
  const double saturation = plane_id % 3 == 2 ? 0.5 : 0.8;
  Rgb color{};
  for (int channel = 0; channel < 3; ++channel) {
    const double position = std::fmod(5.0 - 2.0 * channel + hue, 6.0);
    const double dip = std::clamp(std::min(position, 4.0 - position), 0.0, 1.0);
    color[static_cast<std::size_t>(channel)] =
        static_cast<std::uint8_t>(std::lround(255.0 * value * (1.0 - saturation * dip)));
  }
  return color;
}

}  // namespace planecast::engine
