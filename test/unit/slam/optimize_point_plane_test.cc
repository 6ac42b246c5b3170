#include <gtest/gtest.h>

#include "slam/optimize/bundle.h"
#include "test/unit/slam/synthetic_map.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

constexpr int kPerPlane = 120;

/// A floor and a wall with points on both, and free points between.
std::vector<Eigen::Vector3d> corner_points(Random& random) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < kPerPlane; ++i) {
    const double x = random.uniform(), z = random.uniform();
    points.emplace_back(4.0 * x - 1.5, 1.2, 3.0 + 3.0 * z);
  }
  for (int i = 0; i < kPerPlane; ++i) {
    const double x = random.uniform(), y = random.uniform();
    points.emplace_back(4.0 * x - 1.5, 2.5 * y - 1.3, 6.0);
  }
  for (const Eigen::Vector3d& point : box_points(100, random)) points.push_back(point);
  return points;
}

Plane make_plane(PlaneId id, const Eigen::Vector3d& normal, double offset) {
  Plane plane;
  plane.id = id;
  plane.normal = normal;
  plane.offset = offset;
  plane.origin = -offset * normal;
  plane.x_axis = normal.unitOrthogonal();
  return plane;
}

struct PlaneScene {
  MapScene scene;
  Eigen::Vector3d floor_normal{0.0, -1.0, 0.0};
  Eigen::Vector3d wall_normal{0.0, 0.0, -1.0};
};

/// A bundle-adjusted noisy map whose planes are a little off.
PlaneScene make_plane_scene(bool depth, Random& random) {
  PlaneScene planar;
  MapOptions options;
  options.noise_px = 0.5;
  options.depth = depth;
  planar.scene = make_map(corner_points(random), options, random);
  Map& map = planar.scene.map;
  global_bundle(map, planar.scene.camera, {});
  map.planes.put(
      make_plane(0, (planar.floor_normal + Eigen::Vector3d(0.01, 0.0, 0.02)).normalized(), 1.22));
  map.planes.put(
      make_plane(1, (planar.wall_normal + Eigen::Vector3d(-0.01, 0.01, 0.0)).normalized(), 5.97));
  for (Landmark& landmark : map.landmarks) {
    if (landmark.id < 2 * kPerPlane) landmark.plane = landmark.id < kPerPlane ? 0 : 1;
  }
  return planar;
}

TEST(RefineJointly, LowersThePlaneErrorAndKeepsTheReprojection) {
  Random random(seed_of("RefineJointly.LowersThePlaneErrorAndKeepsTheReprojection"));
  for (const bool depth : {false, true}) {
    PlaneScene planar = make_plane_scene(depth, random);
    JointOptions options;
    options.bundle.iterations = 20;
    const JointResult result = refine_jointly(planar.scene.map, planar.scene.camera, options);
    EXPECT_TRUE(result.kept);
    EXPECT_LT(result.plane_rms_after, 0.6 * result.plane_rms_before);
    EXPECT_LE(result.reprojection_cost_after, 1.01 * result.reprojection_cost_before);
    // The pixel noise over 120 points 3 to 6 units away leaves the planes right to well below
    // these.
    const Map& map = planar.scene.map;
    EXPECT_LT(direction_error_deg(map.planes.at(0).normal, planar.floor_normal), 0.5);
    EXPECT_LT(direction_error_deg(map.planes.at(1).normal, planar.wall_normal), 0.5);
    EXPECT_NEAR(map.planes.at(0).normal.norm(), 1.0, 1e-12);
    EXPECT_LT(map.planes.at(0).rms, 0.02);
  }
}

TEST(RefineJointly, HoldsTheScaleOfAMonocularMap) {
  Random random(seed_of("RefineJointly.HoldsTheScaleOfAMonocularMap"));
  PlaneScene planar = make_plane_scene(false, random);
  const double distance = planar.scene.map.keyframes.at(5).centre_world().norm();
  ASSERT_TRUE(refine_jointly(planar.scene.map, planar.scene.camera, {}).kept);
  EXPECT_NEAR(planar.scene.map.keyframes.at(5).centre_world().norm() / distance, 1.0, 1e-4);
}

TEST(RefineJointly, DropsAResultOverTheLimit) {
  Random random(seed_of("RefineJointly.DropsAResultOverTheLimit"));
  PlaneScene planar = make_plane_scene(false, random);
  const Map before = planar.scene.map;
  JointOptions options;
  options.max_reprojection_rise = -1.0;  // no result is good enough
  EXPECT_FALSE(refine_jointly(planar.scene.map, planar.scene.camera, options).kept);
  for (const Landmark& landmark : before.landmarks) {
    EXPECT_EQ(landmark.position, planar.scene.map.landmarks.at(landmark.id).position);
  }
  EXPECT_EQ(before.planes.at(0).normal, planar.scene.map.planes.at(0).normal);
}

TEST(RefineJointly, LeavesWeakAndMissingPlanesAlone) {
  Random random(seed_of("RefineJointly.LeavesWeakAndMissingPlanesAlone"));
  PlaneScene planar = make_plane_scene(false, random);
  Map& map = planar.scene.map;
  map.planes.at(0).weak = true;
  map.planes.erase(1);
  const Plane weak = map.planes.at(0);
  const JointResult result = refine_jointly(map, planar.scene.camera, {});
  EXPECT_FALSE(result.kept);
  EXPECT_EQ(map.planes.at(0).normal, weak.normal);
  Map empty;
  EXPECT_FALSE(refine_jointly(empty, planar.scene.camera, {}).kept);
}

TEST(RefineJointly, IsRepeatableToTheBit) {
  Random random(seed_of("RefineJointly.IsRepeatableToTheBit"));
  PlaneScene planar = make_plane_scene(true, random);
  Map second = planar.scene.map;
  refine_jointly(planar.scene.map, planar.scene.camera, {});
  refine_jointly(second, planar.scene.camera, {});
  EXPECT_EQ(different_bits(planar.scene.map, second), 0);
  for (const Plane& plane : second.planes) {
    EXPECT_EQ(plane.normal, planar.scene.map.planes.at(plane.id).normal);
    EXPECT_EQ(plane.offset, planar.scene.map.planes.at(plane.id).offset);
  }
}

}  // namespace
}  // namespace planecast::slam
