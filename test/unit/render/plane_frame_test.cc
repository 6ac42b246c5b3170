#include "render/passes/plane_frame.h"

#include <gtest/gtest.h>

#include "render/passes/catcher_plan.h"
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

/// Corners of a cube of side 0.2 whose underside is `lift` above the plane z = 2 of the square.
std::vector<glm::vec3> cube_points(float lift) {
  const auto corners =
      box_corners({{0.4F, 0.4F, 1.8F - lift}, {0.6F, 0.6F, 2.0F - lift}}, glm::mat4(1.0F));
  return {corners.begin(), corners.end()};
}

TEST(CatcherPlan, SharesTheLightAndFindsTheSpot) {
  const PlanePatch patch = square_with_hole();
  Sun sun;
  sun.direction_to_light = glm::vec3(0, 0, -1);
  sun.radiance = glm::vec3(0.3F);
  const Light light = Light::uniform(glm::vec3(0.1F), sun);
  const auto plan = plan_catcher(patch, cube_points(0.0F), light, true, glm::vec3(0.0F));
  ASSERT_TRUE(plan.has_value());
  EXPECT_NEAR(plan->sun_share, 0.75F, 1e-4F);
  EXPECT_NEAR(plan->farthest_gap_m, 0.2F, 1e-5F);
  EXPECT_EQ(plan->contact_strength, 1.0F);
  EXPECT_NEAR(plan->contact_reach_m, 0.3F, 1e-5F);
  // 0.2 wide with 0.3 of reach around it, cut by the polygon at 0.
  EXPECT_NEAR(plan->contact_region.size().x, 0.8F, 1e-5F);
  EXPECT_NEAR(plan->region.size().x, 0.8F, 1e-5F);
  EXPECT_EQ(plan->contact_side % 4, 0);
}

TEST(CatcherPlan, LeavesOutWhatCannotGetDark) {
  const PlanePatch patch = square_with_hole();
  Sun sun = test::no_sun();
  sun.direction_to_light = glm::vec3(0, 0, -1);
  const Light ambient = Light::uniform(glm::vec3(0.1F), sun);
  const glm::vec3 eye(0.0F);
  EXPECT_FALSE(plan_catcher(patch, {}, ambient, true, eye));
  EXPECT_FALSE(plan_catcher(patch, cube_points(0.0F), ambient, false, {0, 0, 9}));  // from behind
  EXPECT_FALSE(plan_catcher(patch, cube_points(-1.0F), ambient, false, eye));  // under the plane
  EXPECT_FALSE(plan_catcher(patch, cube_points(1.0F), ambient, false, eye));   // high above it
  EXPECT_FALSE(plan_catcher(patch, cube_points(0.0F), Light(), true, eye));    // no light to lose
  sun.radiance = glm::vec3(1.0F);
  sun.direction_to_light = glm::vec3(0, 0, 1);
  const auto lit_from_below =
      plan_catcher(patch, cube_points(0.0F), Light::uniform(glm::vec3(0.1F), sun), true, eye);
  ASSERT_TRUE(lit_from_below.has_value());
  EXPECT_FALSE(lit_from_below->sun);
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
