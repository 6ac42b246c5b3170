#include "engine/scene/plane_classes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "table_world.h"

namespace planecast::engine {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// The table world seen by cameras that look down by `pitch_deg` and roll by +-`roll_deg`,
/// described in a world that is turned arbitrarily; returns it and the true up.
Reconstruction turned_world(double pitch_deg, double roll_deg, Eigen::Vector3d& up) {
  Reconstruction world = table_world();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  world.frames.clear();
  for (int i = 0; i < 20; ++i) {
    FrameRecord frame;
    frame.index = i;
    slam::Pose pose = slam::Pose::Identity();
    pose.rotate(Eigen::AngleAxisd((i - 10) * 0.05, Eigen::Vector3d::UnitY()));
    pose.rotate(Eigen::AngleAxisd(-pitch_deg * kDegree, Eigen::Vector3d::UnitX()));
    pose.rotate(
        Eigen::AngleAxisd((i % 2 == 0 ? roll_deg : -roll_deg) * kDegree, Eigen::Vector3d::UnitZ()));
    frame.world_from_cam = slam::Pose(turn) * pose;
    world.frames.push_back(frame);
  }
  for (PlaneRecord& plane : world.planes) {
    plane.normal = turn * plane.normal;
    plane.x_axis = turn * plane.x_axis;
    plane.origin = turn * plane.origin;
    for (Eigen::Vector3d& corner : plane.polygon) corner = turn * corner;
    plane.plane_class = "other";
  }
  up = turn * -Eigen::Vector3d::UnitY();
  return world;
}

TEST(EstimateUp, SnapsToTheRoomWhateverThePitch) {
  for (const double pitch : {-10.0, 0.0, 25.0, 50.0}) {
    Eigen::Vector3d up;
    const Reconstruction world = turned_world(pitch, 6.0, up);
    const UpEstimate estimate = estimate_up(world);
    // The planes are exact, so their common direction must be found exactly.
    EXPECT_LT((estimate.up - up).norm(), 1e-6) << pitch;
    EXPECT_GT(estimate.confidence, 0.3) << pitch;
  }
}

TEST(EstimateUp, ASingleTableIsHorizontalAndASingleWallUpright) {
  Eigen::Vector3d up;
  Reconstruction table = turned_world(45.0, 4.0, up);
  table.planes = {table.planes[1]};
  EXPECT_LT((estimate_up(table).up - up).norm(), 1e-6);
  Reconstruction wall = turned_world(0.0, 4.0, up);
  wall.planes = {wall.planes[2]};
  const UpEstimate estimate = estimate_up(wall);
  EXPECT_LT(std::abs(estimate.up.dot(wall.planes[0].normal)), 0.02);
  EXPECT_GT(estimate.up.dot(up), std::cos(5.0 * kDegree));
}

TEST(EstimateUp, WithoutPlanesTheCamerasTellRoughly) {
  Eigen::Vector3d up;
  Reconstruction world = turned_world(0.0, 5.0, up);
  world.planes.clear();
  const UpEstimate estimate = estimate_up(world);
  EXPECT_GT(estimate.up.dot(up), std::cos(8.0 * kDegree));
  EXPECT_LT(estimate.confidence, 0.3);
}

TEST(EstimateUp, UsersWordCounts) {
  UpOptions options;
  options.known_up = Eigen::Vector3d(0, 0, 3);
  const UpEstimate estimate = estimate_up(table_world(), options);
  EXPECT_EQ(estimate.up, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(estimate.confidence, 1.0);
}

TEST(ClassifyPlanes, NamesTheRoom) {
  Eigen::Vector3d up;
  Reconstruction world = turned_world(20.0, 5.0, up);
  PlaneRecord ceiling = world.planes[0];
  ceiling.id = 3;
  ceiling.normal = -ceiling.normal;
  ceiling.origin += 2.5 * up;
  for (Eigen::Vector3d& corner : ceiling.polygon) corner += 2.5 * up;
  PlaneRecord slope = world.planes[1];
  slope.id = 4;
  slope.normal = Eigen::AngleAxisd(40.0 * kDegree, slope.x_axis) * slope.normal;
  world.planes.push_back(ceiling);
  world.planes.push_back(slope);
  classify_planes(world);
  EXPECT_EQ(world.planes[0].plane_class, "floor");
  EXPECT_EQ(world.planes[1].plane_class, "horizontal");
  EXPECT_EQ(world.planes[2].plane_class, "wall");
  EXPECT_EQ(world.planes[3].plane_class, "ceiling");
  EXPECT_EQ(world.planes[4].plane_class, "other");
}

TEST(ClassifyPlanes, ALoneTableIsNoFloor) {
  Eigen::Vector3d up;
  Reconstruction world = turned_world(40.0, 5.0, up);
  world.planes = {world.planes[1]};
  for (const bool metric : {true, false}) {
    world.metric = metric;
    classify_planes(world);
    EXPECT_EQ(world.planes[0].plane_class, "horizontal");
  }
}

}  // namespace
}  // namespace planecast::engine
