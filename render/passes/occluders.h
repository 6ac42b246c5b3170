#pragma once

#include <vector>

#include "render/gl/objects.h"
#include "render/gl/program.h"
#include "render/scene.h"

namespace planecast::render {

/// Share of the depth by which occluders retreat: the scatter of a plane's points is of this order.
inline constexpr float kOccluderRetreat = 0.003F;

/// Share of the depth over which things vanish behind a depth image.
inline constexpr float kOccluderTolerance = 0.02F;
/// A shadow's plane was fitted to the same depths that occlude it, so it gets more leeway: so many
/// times the tolerance.
inline constexpr float kCatcherTolerance = 2.5F;

/// Writes the depth of flat polygons, concave and with holes, and nothing else. Filled by the
/// even-odd rule in the stencil buffer, so that the measured outlines need neither triangulation
/// nor to be simple. Pushed back by a small share of the depth, so that what stands on a plane is
/// not cut by it.
class OccluderPass {
 public:
  explicit OccluderPass(const Gl& gl);

  /// Into the bound target, whose stencil is clear and stays so.
  void draw(ShaderLibrary& shaders, const std::vector<PlanePatch>& occluders, const Camera& camera);

 private:
  void load(const std::vector<glm::vec3>& points);

  const Gl* gl_;
  BufferHandle points_;
  VertexArrayHandle vertex_array_;
};

}  // namespace planecast::render
