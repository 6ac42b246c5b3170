#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>

#include "render/scene.h"

namespace planecast::render::test {

/// Calls visit(u, v, normal, ray) for pixels of a camera of 640 x 480 on the ball of radius 0.5 at
/// (0, 0, 2), every tenth of the middle rows and columns; `normal` and `ray` are unit vectors.
template <typename Visit>
void over_the_ball(const Camera& camera, const Visit& visit) {
  int count = 0;
  for (int v = 130; v <= 350; v += 10) {
    for (int u = 210; u <= 430; u += 10) {
      const glm::vec3 ray =
          glm::normalize(glm::vec3((static_cast<float>(u) - camera.cx) / camera.fx,
                                   (static_cast<float>(v) - camera.cy) / camera.fy, 1.0F));
      const float along = 2.0F * ray.z;
      const float inside = along * along - (4.0F - 0.25F);
      if (inside < 0.02F) continue;
      visit(u, v, ((along - std::sqrt(inside)) * ray - glm::vec3(0, 0, 2)) / 0.5F, ray);
      ++count;
    }
  }
  ASSERT_GT(count, 100);
}

}  // namespace planecast::render::test
