#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "engine/sequence/synth/camera_effects.h"
#include "engine/sequence/synth/camera_path.h"
#include "engine/sequence/synth/furniture.h"
#include "engine/sequence/synth/light_bake.h"
#include "engine/sequence/synth/ray_caster.h"
#include "engine/sequence/synth/room_model.h"
#include "engine/sequence/synth/scenes.h"

namespace planecast::engine::synth {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

RoomModel floor_with_box() {
  RoomModel model;
  add_flat(model, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, plain(Color::Constant(0.5F)), {"floor"});
  add_box(model, {{0, 0, 0}, 0.0}, {0.6, 0.4, 0.5}, BoxTextures::all(plain(Color::Constant(0.5F))));
  return model;
}

TEST(RoomModel, FacesPointOutwardsAndCarryTheirPlane) {
  const RoomModel model = floor_with_box();
  ASSERT_EQ(model.planes.size(), 6u);  // floor, four sides, top
  EXPECT_EQ(model.planes[0].plane_class, "floor");
  for (std::size_t i = 1; i < model.planes.size(); ++i) {
    const TruePlane& plane = model.planes[i];
    EXPECT_EQ(plane.label, static_cast<int>(i) + 1);
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& corner : plane.polygon) {
      EXPECT_NEAR(plane.normal.dot(corner) + plane.offset, 0.0, 1e-12);
      middle += corner / 4.0;
    }
    EXPECT_GT(plane.normal.dot(middle - Vector3d(0, 0, 0.25)), 0.0);
    // Counter-clockwise from the normal's side.
    const Vector3d turn =
        (plane.polygon[1] - plane.polygon[0]).cross(plane.polygon[2] - plane.polygon[1]);
    EXPECT_GT(turn.dot(plane.normal), 0.0);
  }
  EXPECT_EQ(model.planes.back().plane_class, "horizontal");
  EXPECT_NEAR(model.planes.back().area, 0.24, 1e-6);  // corners lie on whole micrometres
}

TEST(RoomModel, SmallFacesHaveNoLabel) {
  RoomModel model;
  add_box(model, {}, {0.2, 0.2, 0.2}, BoxTextures::all(plain(Color::Ones())));
  EXPECT_TRUE(model.planes.empty());
  for (const Patch& patch : model.patches) EXPECT_EQ(patch.label, 0);
}

TEST(RoomModel, RevolutionNormalsPointOutwards) {
  RoomModel model;
  add_ball(model, {1, 2, 3}, 0.5, plain(Color::Ones()));
  const Patch& ball = model.patches[0];
  for (std::size_t i = 0; i < ball.positions.size(); ++i) {
    EXPECT_GT(ball.normals[i].dot(ball.positions[i] - Vector3f(1, 2, 3)), 0.45F);
  }
}

TEST(RayCaster, FindsTheNearestFace) {
  const RoomModel model = floor_with_box();
  const RayCaster rays(model);
  const RayHit top = rays.nearest({0.05F, 0.07F, 2.0F}, -Vector3f::UnitZ(), 10.0F);
  EXPECT_NEAR(top.distance, 1.5F, 1e-6F);
  EXPECT_EQ(top.patch, 5);
  const RayHit floor = rays.nearest({1.0F, 0.9F, 2.0F}, -Vector3f::UnitZ(), 10.0F);
  EXPECT_NEAR(floor.distance, 2.0F, 1e-6F);
  EXPECT_EQ(floor.patch, 0);
  EXPECT_TRUE(rays.blocked({-1.0F, 0.03F, 0.2F}, Vector3f::UnitX(), 2.0F));
  EXPECT_FALSE(rays.blocked({-1.0F, 0.03F, 0.2F}, Vector3f::UnitX(), 0.6F));
  EXPECT_FALSE(rays.blocked({-1.0F, 0.3F, 0.2F}, Vector3f::UnitX(), 2.0F));
}

TEST(LightBake, ALampLightsByTheInverseSquareAndTheBoxThrowsAShadow) {
  RoomModel model = floor_with_box();
  model.ambient = Color::Zero();
  LampLight lamp;
  lamp.position = Vector3f(-1.0F, 0.0F, 1.0F);
  lamp.radius_m = 0.0F;
  lamp.intensity = Color::Constant(std::numbers::pi_v<float>);
  model.lamps.push_back(lamp);
  const RayCaster rays(model);
  const LightMap map = bake_light(model, {6, Color::Constant(0.5F)}, rays, 0, {});
  const auto light_at = [&map](float x, float y) { return map.at((x + 2) / 4, (y + 2) / 4).x(); };
  // Under the lamp 1 / 1^2; one metre aside cos(45 deg) / 2. The grid blurs by some percent.
  EXPECT_NEAR(light_at(-1.0F, 0.0F), 1.0F, 0.03F);
  EXPECT_NEAR(light_at(-1.0F, 1.0F), 0.3536F, 0.01F);
  EXPECT_EQ(light_at(0.6F, 0.0F), 0.0F);  // behind the box
  // Its shadow ends at x = 1.6; beyond, (1 / 2.97) / (2.8^2 + 1) at x = 1.8.
  EXPECT_NEAR(light_at(1.8F, 0.0F), 0.0380F, 0.003F);
}

TEST(CameraPath, IsSmoothAndOfAHandsSpeed) {
  for (const std::string& name : scene_names()) {
    const CameraPath path = make_scene(name, 1)->path;
    constexpr double kStep = 1.0 / 60.0;
    double distance = 0.0;
    slam::Pose before = path.world_from_cam(0.0);
    Vector3d velocity_before = Vector3d::Zero();
    for (double t = kStep; t < path.duration_s(); t += kStep) {
      const slam::Pose now = path.world_from_cam(t);
      const Vector3d velocity = (now.translation() - before.translation()) / kStep;
      const double turn = Eigen::AngleAxisd(before.linear().transpose() * now.linear()).angle();
      distance += velocity.norm() * kStep;
      EXPECT_LT(velocity.norm(), 1.0) << name << " at " << t;
      EXPECT_LT(turn / kStep * 180.0 / std::numbers::pi, 45.0) << name << " at " << t;
      if (t > kStep) {  // no jumps: less than 8 m/s^2
        EXPECT_LT((velocity - velocity_before).norm() / kStep, 8.0) << name << " at " << t;
      }
      velocity_before = velocity;
      before = now;
    }
    EXPECT_LT(distance / path.duration_s(), 0.6) << name;
  }
}

TEST(CameraPath, StaysAtEyeHeightInsideTheRoomWithALevelHorizon) {
  const CameraPath path = make_scene("room", 1)->path;
  for (double t = 0.0; t < path.duration_s(); t += 0.1) {
    const slam::Pose pose = path.world_from_cam(t);
    EXPECT_NEAR(pose.translation().z(), 1.5, 0.15);
    EXPECT_LT(pose.linear().col(1).z(), -0.7);  // the image's down is the world's
    EXPECT_LT(std::abs(pose.linear().col(0).z()), 0.06);
  }
  const Vector3d back =
      path.world_from_cam(path.duration_s()).translation() - path.world_from_cam(0.0).translation();
  EXPECT_LT(back.norm(), 0.1);  // a loop
}

TEST(CameraPath, TheRingComesBackAndSeesNoPlaceTwiceBefore) {
  const CameraPath path = make_scene("ring", 1)->path;
  const Vector3d first = path.world_from_cam(0.0).translation();
  const double end_s = path.duration_s();
  // Two metres at the end repeat the beginning: the hand sways by some centimetres.
  const double repeated_s = 2.0 / 0.55;
  EXPECT_LT((path.world_from_cam(end_s - repeated_s).translation() - first).norm(), 0.15);
  EXPECT_LT(
      (path.world_from_cam(end_s).translation() - path.world_from_cam(repeated_s).translation())
          .norm(),
      0.15);
  double farthest = 0.0;
  // From two metres after the start to two metres before it is reached again.
  for (double t = repeated_s; t < end_s - 2.0 * repeated_s; t += 0.1) {
    const Vector3d eye = path.world_from_cam(t).translation();
    farthest = std::max(farthest, (eye - first).norm());
    EXPECT_GT((eye - first).norm(), 0.8) << t;
    // In the corridor: outside the block and inside the outer walls.
    EXPECT_GT(std::max(std::abs(eye.x() - 3.0), std::abs(eye.y() - 3.0)), 1.5) << t;
    EXPECT_LT(std::max(std::abs(eye.x() - 3.0), std::abs(eye.y() - 3.0)), 2.6) << t;
  }
  EXPECT_GT(farthest, 4.0);
}

TEST(CameraPath, TheRevisitedRoomGoesOnForAsLongAsAsked) {
  const CameraPath path = make_scene("revisit", 1)->path;
  EXPECT_DOUBLE_EQ(path.duration_s(), 100.0);
  for (const double lap : {30.0, 300.0, 3000.0}) {
    const Vector3d moved =
        path.world_from_cam(lap + 1.0).translation() - path.world_from_cam(lap).translation();
    EXPECT_GT(moved.norm(), 0.1) << lap;
  }
}

TEST(Scenes, RotationStartOnlyTurnsAtFirst) {
  const CameraPath path = make_scene("rotation-start", 1)->path;
  const Vector3d first = path.world_from_cam(0.0).translation();
  double turned = 0.0;
  for (double t = 0.0; t < 2.4; t += 0.05) {
    EXPECT_LT((path.world_from_cam(t).translation() - first).norm(), 0.004);
    turned = std::max(turned, Eigen::AngleAxisd(path.world_from_cam(0.0).linear().transpose() *
                                                path.world_from_cam(t).linear())
                                  .angle());
  }
  EXPECT_GT(turned, 0.3);
  EXPECT_GT((path.world_from_cam(6.0).translation() - first).norm(), 0.5);
}

TEST(Scenes, LabelsFitIntoEightBitsAndCoverTheMainSurfaces) {
  for (const std::string& name : scene_names()) {
    const auto scene = make_scene(name, 1);
    EXPECT_LT(scene->model.planes.size(), 255u) << name;
    std::set<std::string> classes;
    for (const TruePlane& plane : scene->model.planes) classes.insert(plane.plane_class);
    EXPECT_TRUE(classes.contains("floor")) << name;
    EXPECT_EQ(classes.contains("wall"), name != "plane") << name;
  }
  EXPECT_FALSE(make_scene("no such scene", 1));
}

TEST(DegradeDepth, MakesHolesAtEdgesAndNoiseOfTheSensorsSize) {
  cv::Mat depth(120, 160, CV_32F, cv::Scalar(2.0));
  depth(cv::Rect(80, 0, 80, 120)).setTo(3.0);
  degrade_depth(depth, 131.0, 3, 1);
  int holes = 0;
  double squares = 0.0;
  int count = 0;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < 70; ++x) {
      const float z = depth.at<float>(y, x);
      if (z == 0.0F) {
        ++holes;
        continue;
      }
      squares += (z - 2.0) * (z - 2.0);
      ++count;
    }
  }
  EXPECT_EQ(holes, 0);
  // sigma_z(2 m) = 0.0012 + 0.0019 * 1.6^2 = 6.1 mm; 8,400 samples tell it to about 1 %.
  EXPECT_NEAR(std::sqrt(squares / count), 0.0061, 0.0003);
  const cv::Mat edge = depth(cv::Rect(78, 0, 4, 120)) == 0.0F;
  EXPECT_GT(cv::countNonZero(edge), 60);
}

TEST(CameraEffects, NoiseVignettingAndRepeatability) {
  EffectOptions options;
  options.exposure_drift = 0.0;
  const CameraEffects effects(options, 160, 120, 5);
  cv::Mat a(120, 160, CV_8UC3, cv::Scalar(128, 128, 128));
  cv::Mat b = a.clone();
  cv::Mat c = a.clone();
  effects.apply(a, 7, 0.5, {0, 0});
  effects.apply(b, 7, 0.5, {0, 0});
  effects.apply(c, 8, 0.5, {0, 0});
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(a, c, cv::NORM_INF), 0.0);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(a(cv::Rect(70, 50, 20, 20)), mean, deviation);
  EXPECT_NEAR(mean[0], 128.0, 1.0);
  EXPECT_NEAR(deviation[1], options.noise_sigma, 0.35);
  // A corner keeps 1 - 0.22 of the light: 128 * 0.78^(1 / 2.2) = 114.
  EXPECT_NEAR(cv::mean(a(cv::Rect(0, 0, 6, 6)))[0], 115.0, 2.5);
}

}  // namespace
}  // namespace planecast::engine::synth
