#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "render/environment.h"
#include "render/scene.h"
#include "render/software/surface_lanes.h"

namespace planecast::render {

/// An environment's cubes in memory as they are read: each face of each level with a border of a
/// texel of its neighbours, RGB and something unused.
class EnvironmentTexels {
 public:
  static constexpr std::size_t kMostLevels = 16;

  explicit EnvironmentTexels(const Environment& environment);

  int levels() const { return levels_; }
  /// Radiance from the directions (x, y, z) at the roughnesses' levels, 0 the sharpest; blended
  /// between texels and levels.
  void read(const LaneVec3& directions, const Lane& level, LaneVec3& radiance) const;

 private:
  int levels_ = 0;
  std::array<std::int32_t, kMostLevels> first_{};  ///< texel of each level
  std::array<std::int32_t, kMostLevels> side_{};   ///< without the border
  std::vector<F4> texels_;
};

/// What surfaces reflect instead of the harmonics.
struct Reflections {
  const EnvironmentTexels* texels = nullptr;  ///< null: the harmonics
  glm::mat3 environment_from_world = glm::mat3(1.0F);
  float gain = 1.0F;
};

/// Fills in what the mirrored eye sees: as reflected_ambient() of model.frag with an environment.
void find_reflections(SurfaceLanes& lanes, const glm::vec3& eye, const Reflections& reflections);

/// Keeps the texels of the environment that was last asked for.
class EnvironmentInMemory {
 public:
  /// The scene's, or none.
  Reflections reflections(const Light& light);
  void clear();

 private:
  std::shared_ptr<const Environment> source_;
  std::unique_ptr<EnvironmentTexels> texels_;
};

}  // namespace planecast::render
