#include "render/passes/plane_frame.h"

#include <gtest/gtest.h>

#include "render/passes/shadow_map.h"
#include "render/passes/view.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

PlanePatch square_with_hole() {
  PlanePatch patch;
  patch.normal = {0, 0, -1};
  patch.outer = {{0, 0, 2}, {0, 4, 2}, {4, 4, 2}, {4, 0, 2}};
  patch.holes = {{{1, 1, 2}, {3, 1, 2}, {3, 3, 2}, {1, 3, 2}}};
  return patch;
}

TEST(PlaneFrame, IsRightHandedAndInvertsItself) {
  const PlaneFrame frame = plane_frame(square_with_hole());
  EXPECT_NEAR(glm::dot(glm::cross(frame.x, frame.y), frame.normal), 1.0F, 1e-6F);
  const glm::vec3 p(3.0F, 0.5F, 2.0F);
  EXPECT_LT(glm::length(frame.world(frame.coordinates(p)) - p), 1e-6F);
  EXPECT_NEAR(frame.height({0, 0, 1.5F}), 0.5F, 1e-6F);
  EXPECT_NEAR(glm::dot(frame.equation(), glm::vec4(p, 1.0F)), 0.0F, 1e-6F);
}

TEST(DistanceToEdge, IsExactAndKnowsHoles) {
  const PlanePatch patch = square_with_hole();
  const PlaneFrame frame = plane_frame(patch);
  const PlaneRegion region = outer_region(patch, frame);
  const ImageF distance = distance_to_edge(patch, frame, region, 80);
  ASSERT_EQ(distance.width, 80);
  const auto at_world = [&](float x, float y) {
    const glm::vec2 share = (frame.coordinates({x, y, 2}) - region.min) / region.size();
    return test::at(distance, static_cast<int>(share.x * 80.0F), static_cast<int>(share.y * 80.0F));
  };
  // Cells are 0.05 wide and read at their centres.
  EXPECT_NEAR(at_world(0.52F, 2.02F), 0.48F, 0.06F);
  EXPECT_NEAR(at_world(2.02F, 2.02F), -0.98F, 0.06F);
  EXPECT_NEAR(at_world(0.02F, 0.02F), 0.02F, 0.06F);
}

TEST(ShadowProjection, HoldsAllPointsWithTheMarginFree) {
  const std::vector<glm::vec3> points = {{-1, 2, 5}, {3, 0.5F, 4}, {0, 0, 7}, {1, 1, 1}};
  constexpr int kSize = 256;
  constexpr float kMargin = 6.0F;
  const ShadowProjection projection = fit_shadow({0.3F, -0.8F, 0.1F}, points, kSize, kMargin);
  const float edge = 1.0F - 2.0F * kMargin / kSize + 1e-4F;
  for (const glm::vec3& point : points) {
    const glm::vec4 clip = projection.clip_from_world * glm::vec4(point, 1.0F);
    EXPECT_LE(std::abs(clip.x), edge);
    EXPECT_LE(std::abs(clip.y), edge);
    EXPECT_GT(clip.z, 0.0F);
    EXPECT_LT(clip.z, 1.0F);
  }
  // Depth grows by metres / depth_m away from the light.
  const glm::vec3 away = -glm::normalize(glm::vec3(0.3F, -0.8F, 0.1F));
  const glm::vec4 a = projection.clip_from_world * glm::vec4(points[0], 1.0F);
  const glm::vec4 b = projection.clip_from_world * glm::vec4(points[0] + 0.5F * away, 1.0F);
  EXPECT_NEAR((b.z - a.z) * projection.depth_m, 0.5F, 1e-4F);
}

TEST(ProjectedBounds, CoversPointsAndClipsAtTheCamera) {
  Camera camera;
  const Layer::Rect inside = projected_bounds(camera, {{0, 0, 2}, {0.1F, 0.2F, 2}});
  EXPECT_LE(inside.x, 319);
  EXPECT_LE(inside.y, 239);
  EXPECT_GE(inside.x + inside.width, 347);
  EXPECT_GE(inside.y + inside.height, 293);
  EXPECT_LT(inside.width, 35);
  EXPECT_EQ(projected_bounds(camera, {{0, 0, -2}, {1, 0, -1}}).width, 0);
  // A floor running under the camera fills the lower half.
  const Layer::Rect floor =
      projected_bounds(camera, {{-9, 1, 9}, {9, 1, 9}, {9, 1, -9}, {-9, 1, -9}});
  EXPECT_EQ(floor.x, 0);
  EXPECT_EQ(floor.width, 640);
  EXPECT_EQ(floor.y + floor.height, 480);
  EXPECT_LE(floor.y, 240 + 59);
}

}  // namespace
}  // namespace planecast::render
