#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/passes/targets.h"
#include "render/software/sample_grid.h"

namespace planecast::render {

/// A ring of the world as the camera sees it, in pixels of the window (centres at integers): cut at
/// the near plane and at the window's border. What the even-odd rule says of the window's samples
/// stays as it was. `camera_from_ring` maps the ring's points.
std::vector<glm::vec2> clip_to_window(const std::vector<glm::vec3>& ring,
                                      const glm::mat4& camera_from_ring, const Camera& camera,
                                      const Window& window);

/// Depth on the screen of the plane equation . (p, 1) = 0 in the camera's frame, over the window.
DepthPlane depth_of_plane(const glm::vec4& camera_equation, const Camera& camera,
                          const Window& window);

/// Reversed depth, 1 at the near plane and 0 at the far one: x + y / z.
glm::vec2 depth_coefficients(const Camera& camera);

}  // namespace planecast::render
