#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/software/lanes.h"
#include "render/software/sun_map.h"

namespace planecast::render {

/// The levels of a penumbra map in memory. Each has a border of a texel where nothing blocks the
/// light, so that reading clamps.
struct PenumbraLevels {
  static constexpr std::size_t kMost = 16;
  int count = 0;
  std::array<std::int32_t, kMost> first{};  ///< texel of each level
  std::array<std::int32_t, kMost> side{};   ///< with the border
  std::vector<float> blocked;               ///< share of the light's rays
  std::vector<float> gap_m;                 ///< what blocks to the plane, times that share
};

/// Which rays of the light are blocked before a plane and how far before it, averaged over ever
/// larger parts of the sun's map: as penumbra.frag and its mip levels.
class PenumbraMap {
 public:
  /// `plane`: its equation in the world.
  void make(const SunMap& sun, const glm::vec4& plane);
  const PenumbraLevels& levels() const { return levels_; }

 private:
  void allot(int side);

  PenumbraLevels levels_;
};

}  // namespace planecast::render
