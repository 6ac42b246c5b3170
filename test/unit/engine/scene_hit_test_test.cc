#include "engine/scene/hit_test.h"

#include <gtest/gtest.h>

#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"
#include "table_world.h"

namespace planecast::engine {
namespace {

/// Pixel of a world point in frame 10, whose camera is the world.
Eigen::Vector2d pixel_of(const Reconstruction& world, const Eigen::Vector3d& point) {
  return world.camera.distort(world.camera.project(point));
}

std::string tap_error(const Reconstruction& world, int frame, const Eigen::Vector2d& pixel) {
  try {
    tap(world, frame, pixel, false, "s.yaml:3");
  } catch (const UserError& error) {
    return error.what();
  }
  return "no error";
}

constexpr double kExact = 1e-9;  // metres: double arithmetic on a scene of a few metres

TEST(HitTest, MeetsTheNearestPlaneAtTheTappedPoint) {
  const Reconstruction world = table_world();
  const Eigen::Vector3d on_table(0.2, 0.5, 1.6);
  const Hit table = tap(world, 10, pixel_of(world, on_table), false, "t");
  EXPECT_EQ(table.plane_id, 1);
  EXPECT_LT((table.point - on_table).norm(), kExact);
  EXPECT_NEAR(table.depth, 1.6, kExact);
  const Eigen::Vector3d on_floor(2.0, 1.3, 3.2);
  EXPECT_EQ(tap(world, 10, pixel_of(world, on_floor), false, "t").plane_id, 0);
  const Eigen::Vector3d on_wall(-1.0, -0.5, 4.0);
  EXPECT_EQ(tap(world, 10, pixel_of(world, on_wall), false, "t").plane_id, 2);
}

TEST(HitTest, UndistortsThePixel) {
  Reconstruction world = table_world();
  world.camera.distortion = {0.26, -0.95, -0.005, 0.003, 1.16};
  const Eigen::Vector3d on_table(0.3, 0.5, 1.5);
  const Hit hit = tap(world, 10, pixel_of(world, on_table), false, "t");
  // Camera::undistort promises 1e-6 px; at 500 px focal length and 1.5 m that is far below 1e-6 m.
  EXPECT_LT((hit.point - on_table).norm(), 1e-6);
}

TEST(HitTest, GrowsOutlinesOnlyWhereNothingIsHit) {
  Reconstruction world = table_world();
  // 5 cm before the table's front edge the floor is behind: an exact hit wins over a grown outline.
  const Eigen::Vector3d beside(0.0, 0.5, 0.95);
  EXPECT_EQ(tap(world, 10, {319.5, 475.0}, false, "t").plane_id, 1);
  const Ray ray{Eigen::Vector3d::Zero(), beside / beside.z()};
  ASSERT_TRUE(hit_test(world.planes, ray).has_value());
  EXPECT_EQ(hit_test(world.planes, ray)->plane_id, 0);
  world.planes.erase(world.planes.begin());
  ASSERT_TRUE(hit_test(world.planes, ray).has_value());
  EXPECT_EQ(hit_test(world.planes, ray)->plane_id, 1);
  EXPECT_FALSE(hit_test(world.planes, ray, {0.0}).has_value());
}

TEST(HitTest, PassesThroughHolesAndBacks) {
  Reconstruction world = table_world();
  plane_by_id(world, 1).holes = {level_ring(0.5, -0.2, 0.2, 1.4, 1.6)};
  const Ray through_hole{Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.5 / 1.5, 1.0)};
  EXPECT_EQ(hit_test(world.planes, through_hole)->plane_id, 0);
  const Ray from_below{{0.0, 1.0, 1.5}, {0.0, -1.0, 0.001}};
  EXPECT_FALSE(hit_test(world.planes, from_below).has_value());
}

TEST(HitTest, SaysWhatIsThereInstead) {
  Reconstruction world = table_world();
  world.planes.pop_back();
  EXPECT_EQ(tap_error(world, 10, {320, 10}),
            "s.yaml:3: there is no plane at pixel (320, 10) of frame 10; planes in that frame: "
            "0 (floor), 1 (horizontal)");
  EXPECT_EQ(tap_error(world, 11, {320, 10}),
            "s.yaml:3: frame 11 has no camera pose (lost: too few matches); the nearest frame with "
            "one is 10");
  EXPECT_EQ(tap_error(world, 99, {320, 10}), "s.yaml:3: frame 99 is not there (frames: 10 to 12)");
  EXPECT_EQ(tap_error(world, 10, {640, 10}),
            "s.yaml:3: pixel (640, 10) of frame 10 lies outside the picture (640x480)");
}

TEST(PlaneOutline, MergedPlanesAreFoundByTheirOldIds) {
  Reconstruction world = table_world();
  plane_by_id(world, 1).merged_from = {5, 8};
  EXPECT_EQ(find_plane(world.planes, 8)->id, 1);
  EXPECT_EQ(find_plane(world.planes, 3), nullptr);
}

TEST(PlaneOutline, DistanceAndContainment) {
  PlaneOutline outline;
  outline.outer = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  outline.holes = {{{1, 1}, {1, 2}, {2, 2}, {2, 1}}};
  EXPECT_TRUE(contains(outline, {3, 3}));
  EXPECT_FALSE(contains(outline, {1.5, 1.5}));
  EXPECT_FALSE(contains(outline, {5, 3}));
  EXPECT_NEAR(distance_to_edge(outline, {3, 3}), 1.0, kExact);
  EXPECT_NEAR(distance_to_edge(outline, {2.25, 1.5}), 0.25, kExact);
}

}  // namespace
}  // namespace planecast::engine
