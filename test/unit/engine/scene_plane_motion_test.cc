#include "engine/scene/plane_motion.h"

#include <gtest/gtest.h>

#include "engine/output/map_changes.h"
#include "engine/scene/plane_outline.h"
#include "engine/user_error.h"
#include "output_test_files.h"
#include "table_world.h"

namespace planecast::engine {
namespace {

constexpr double kExact = 1e-12;

slam::Pose shifted(const slam::Pose& pose, const Eigen::Vector3d& by) {
  slam::Pose moved = pose;
  moved.translation() += by;
  return moved;
}

/// The table (plane 1) was known from frame 5 on, 0.1 too low, and took its place at frame 10; the
/// camera did not move with that change. Frames 0..29.
Reconstruction changing_world() {
  Reconstruction world = table_world();
  world.frames.clear();
  for (int i = 0; i < 30; ++i) {
    FrameRecord frame;
    frame.index = i;
    world.frames.push_back(frame);
  }
  const slam::Pose final_pose = world.planes[1].world_from_plane();
  MapChange first;
  first.frame_index = 5;
  first.planes = {{1, shifted(final_pose, {0, 0.1, 0})}};
  MapChange second;
  second.frame_index = 10;
  second.planes = {{1, final_pose}};
  world.map_changes = {first, second};
  return world;
}

double height_at(const PlaneMotion& motion, int frame) {
  return motion.world_from_plane(1, frame)->translation().y();
}

TEST(PlaneMotion, ChangesReachTheContentOverSomeFrames) {
  const Reconstruction world = changing_world();
  const PlaneMotion motion(world, 8);
  EXPECT_FALSE(motion.world_from_plane(1, 4).has_value());
  EXPECT_NEAR(height_at(motion, 5), 0.6, kExact);
  EXPECT_NEAR(height_at(motion, 9), 0.6, kExact);
  // Nothing jumps at the change, it is over after eight frames, and no step is more than a fifth.
  EXPECT_NEAR(height_at(motion, 10), 0.6, kExact);
  EXPECT_NEAR(height_at(motion, 18), 0.5, kExact);
  for (int i = 10; i < 18; ++i) {
    const double step = height_at(motion, i) - height_at(motion, i + 1);
    EXPECT_GT(step, 0.0);
    EXPECT_LT(step, 0.02);
  }
  const PlaneMotion at_once(world, 0);
  EXPECT_NEAR(height_at(at_once, 9), 0.6, kExact);
  EXPECT_NEAR(height_at(at_once, 10), 0.5, kExact);
}

TEST(PlaneMotion, ContentGoesWithTheCameraWhenTheMapMoves) {
  Reconstruction world = changing_world();
  // A closed loop moved the map about the camera by 0.3, and the table by 0.3 and a bit.
  const Eigen::Vector3d jump(0.3, 0.0, 0.0);
  world.map_changes[1].new_from_old_world.translation() = jump;
  const slam::Pose before = world.map_changes[0].planes[0].world_from_plane;
  world.map_changes[1].planes[0].world_from_plane = shifted(before, jump * 1.1);
  const PlaneMotion motion(world, 8);
  const auto x = [&](int frame) { return motion.world_from_plane(1, frame)->translation().x(); };
  EXPECT_NEAR(x(10) - x(9), 0.3, kExact);  // as the camera: in the picture it stays where it was
  EXPECT_NEAR(x(18) - x(9), 0.33, kExact);
}

TEST(PlaneMotion, MergesHandContentOverWithoutAMove) {
  Reconstruction world = changing_world();
  // Plane 7 stood for the table before it was merged into it.
  world.planes[1].merged_from = {7};
  world.map_changes[0].planes[0].id = 7;
  slam::Pose& seven = world.map_changes[0].planes[0].world_from_plane;
  seven.translation() += Eigen::Vector3d(0.4, 0.0, 0.2);
  seven.linear() = Eigen::AngleAxisd(0.5, seven.linear().col(2)) * seven.linear();
  const PlaneMotion motion(world, 0);
  EXPECT_LT(
      (motion.world_from_plane(1, 9)->matrix() - motion.world_from_plane(1, 10)->matrix()).norm(),
      kExact);
  EXPECT_TRUE(motion.world_from_plane(7, 12).has_value());
}

TEST(PlaneMotion, PlanesAsKnownMoveWithTheirOutline) {
  const Reconstruction world = changing_world();
  const auto early = planes_as_known(world, 7);
  EXPECT_NEAR(early[1].polygon[0].y(), 0.6, kExact);
  EXPECT_NEAR(early[1].normal.dot(early[1].polygon[2]) + early[1].offset, 0.0, kExact);
  EXPECT_NEAR(planes_as_known(world, 2)[1].polygon[0].y(), 0.6, kExact);  // as it first appears
  EXPECT_NEAR(planes_as_known(world, 12)[1].polygon[0].y(), 0.5, kExact);
  EXPECT_NEAR(early[0].polygon[0].y(), 1.3, kExact);  // of the floor nothing is recorded
}

/// Pixel of the camera's picture where what was tapped is drawn.
Eigen::Vector2d seen_from(const Reconstruction& world, const slam::Pose& world_from_cam,
                          const slam::Pose& world_from_plane, const Eigen::Vector3d& in_plane) {
  return world.camera.project(world_from_cam.inverse() * (world_from_plane * in_plane));
}

TEST(PlaneMotion, WhatWasTappedStaysOnTheRayOfItsTap) {
  Reconstruction world = changing_world();
  const slam::Pose tapping = slam::Pose::Identity();
  world.frames[6].causal_world_from_cam = tapping;
  world.keyframes = {{5, 5.0, tapping}};
  // At the change the keyframe that carries the frame turns out to stand a little elsewhere.
  const slam::Pose better = shifted(tapping, {0.03, -0.02, 0.01});
  world.map_changes[0].keyframes = {{5, tapping}};
  world.map_changes[1].keyframes = {{5, better}};
  const Tap tap{6, Eigen::Vector3d(0.05, 0.3, 1.0)};
  const PlaneMotion motion(world, 8);
  const auto poses = motion.world_from_plane_under(tap, 1);
  ASSERT_EQ(poses.size(), 30U);
  ASSERT_TRUE(poses[6] && poses[29]);
  // Down to where the table stood 0.1 too low.
  const double along = 0.6 / tap.direction_cam.y();
  const Eigen::Vector3d in_plane = poses[6]->inverse() * (along * tap.direction_cam);
  const Eigen::Vector2d pixel = world.camera.project(tap.direction_cam);
  EXPECT_LT((seen_from(world, tapping, *poses[6], in_plane) - pixel).norm(), 1e-9);
  EXPECT_LT((seen_from(world, better, *poses[29], in_plane) - pixel).norm(), 1e-9);
  EXPECT_NEAR((*poses[29] * in_plane).y(), 0.5, kExact);
  // The plane's own motion alone would leave it beside the ray.
  const slam::Pose alone = *motion.world_from_plane(1, 29);
  EXPECT_GT((seen_from(world, better, alone, in_plane) - pixel).norm(), 5.0);
}

TEST(PlaneMotion, WithoutARecordPlanesStandStill) {
  Reconstruction world = changing_world();
  world.map_changes.clear();
  const PlaneMotion motion(world, 8);
  EXPECT_NEAR(height_at(motion, 0), 0.5, kExact);
}

TEST(MapChanges, ComeBackFromTheirFile) {
  const TestFolder folder;
  Reconstruction world = changing_world();
  world.map_changes[1].new_from_old_world =
      slam::Pose(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()));
  world.map_changes[1].keyframes = {{4, world.map_changes[1].new_from_old_world}};
  write_map_changes(world.map_changes, folder / "map_changes.csv");
  const auto read = read_map_changes(folder / "map_changes.csv");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].frame_index, 10);
  EXPECT_TRUE(read[1].new_from_old_world.isApprox(world.map_changes[1].new_from_old_world, 1e-14));
  ASSERT_EQ(read[1].planes.size(), 1U);
  EXPECT_EQ(read[1].planes[0].id, 1);
  EXPECT_TRUE(read[1].planes[0].world_from_plane.isApprox(
      world.map_changes[1].planes[0].world_from_plane, 1e-14));
  ASSERT_EQ(read[1].keyframes.size(), 1U);
  EXPECT_EQ(read[1].keyframes[0].frame_index, 4);
  EXPECT_TRUE(read[1].keyframes[0].world_from_cam.isApprox(
      world.map_changes[1].keyframes[0].world_from_cam, 1e-14));
  EXPECT_TRUE(read_map_changes(folder / "none.csv").empty());
  write_file(folder / "bad.csv", "frame,kind,id,tx,ty,tz,qx,qy,qz,qw\n3,plane,2,0,0,0,0,0,0,1\n");
  EXPECT_THROW(read_map_changes(folder / "bad.csv"), UserError);
}

}  // namespace
}  // namespace planecast::engine
