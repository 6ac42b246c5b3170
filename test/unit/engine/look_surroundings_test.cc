#include "engine/look/surroundings.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "engine/convert.h"
#include "render/environment.h"

namespace planecast::engine {
namespace {

slam::Camera wide_camera() {
  slam::Camera camera;
  camera.width = 160;
  camera.height = 160;
  camera.fx = camera.fy = 80.0;
  camera.cx = camera.cy = 79.5;
  return camera;
}

slam::Pose turned(double degrees) {
  slam::Pose pose = slam::Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY())
                      .toRotationMatrix();
  pose.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  return pose;
}

float red_at(const render::ImageF& map, const Eigen::Vector3d& direction) {
  return render::Environment(map).radiance(to_glm(direction), 0.0F).r;
}

/// Two walls, of different brightness, seen ahead (+z) and to the right (+x); behind is guessed.
TEST(Surroundings, WhatWasSeenLiesWhereItWasSeen) {
  Surroundings surroundings;
  surroundings.add(cv::Mat(160, 160, CV_8UC3, cv::Scalar(0, 0, 188)), wide_camera(), turned(0));
  surroundings.add(cv::Mat(160, 160, CV_8UC3, cv::Scalar(0, 0, 255)), wide_camera(), turned(90));
  EXPECT_NEAR(surroundings.seen(), 2.0 / 6.0, 0.02) << "two faces of a cube";
  SceneLight light;
  light.mean = Eigen::Vector3d::Constant(0.7);
  const render::ImageF map = surroundings.panorama(light);
  EXPECT_NEAR(red_at(map, {0, 0, 1}), 0.5, 0.02);
  EXPECT_NEAR(red_at(map, {1, 0, 0}), 1.0, 0.02);
  EXPECT_NEAR(red_at(map, {-1, 0, -1}), 0.7, 0.01) << "nothing was seen there";
}

TEST(Surroundings, ExposureIsTakenOut) {
  Surroundings surroundings;
  surroundings.add(cv::Mat(160, 160, CV_8UC1, cv::Scalar(188)), wide_camera(), turned(0), 2.0);
  EXPECT_NEAR(red_at(surroundings.panorama({}), {0, 0, 1}), 0.25, 0.01);
}

}  // namespace
}  // namespace planecast::engine
