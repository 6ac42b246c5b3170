#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/image.h"

namespace planecast::render {

struct EnvironmentOptions {
  int side = 128;     ///< texels of a cube face at roughness 0; a power of two
  int samples = 128;  ///< directions a texel of the blurred levels is the mean of
  int smallest = 4;   ///< side at roughness 1
  int threads = 1;    ///< that compute it; changes no result
};

/// Surroundings infinitely far away, as a cube of radiance for each of several roughnesses: the
/// first sum of Karis, "Real Shading in Unreal Engine 4" (SIGGRAPH 2013 course notes), with
/// view = normal. Faces and their rows are in OpenGL's order. Computed once, by the processor.
class Environment {
 public:
  /// `map`: equirectangular, three channels of linear radiance, up (+y) in its first row, -z in its
  /// middle column and +x right of that. Negative values and what is no number count as black.
  /// Throws std::invalid_argument for an empty map or another number of channels.
  explicit Environment(const ImageF& map, const EnvironmentOptions& options = {});

  int levels() const { return static_cast<int>(cubes_.size()); }
  int side(int level) const { return options_.side >> level; }
  /// RGB of the six faces one after another. Roughness grows evenly from 0 in level 0 to 1 in the
  /// last.
  const std::vector<glm::vec3>& texels(int level) const {
    return cubes_[static_cast<std::size_t>(level)];
  }
  /// A texel of a face's level by column and row; one beyond the border is the nearest of the face
  /// that is there.
  glm::vec3 texel(int level, int face, int x, int y) const;
  /// As the shaders read it but without blending texels; `direction` in the map's axes.
  glm::vec3 radiance(const glm::vec3& direction, float roughness) const;
  /// Light::ambient_sh of a world whose directions `map_from_world` turns into the map's.
  std::array<glm::vec3, 9> harmonics(const glm::mat3& map_from_world) const;

 private:
  EnvironmentOptions options_;
  std::vector<std::vector<glm::vec3>> cubes_;    ///< by roughness
  std::vector<std::vector<glm::vec3>> pyramid_;  ///< unblurred, each half of the one before
};

/// Direction of a place of an equirectangular map; (0, 0) and (1, 1) are its corners.
glm::vec3 equirectangular_direction(glm::vec2 place);

}  // namespace planecast::render
