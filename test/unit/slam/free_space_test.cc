#include "slam/stages/free_space.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace planecast::slam {
namespace {

constexpr float kWall = 3.0F;
const cv::Rect kBox(120, 80, 64, 64);

/// A wall straight ahead, with a box before it unless its depth is 0.
cv::Mat wall_with_box(float box_m, float wall_m = kWall) {
  cv::Mat depth(240, 320, CV_32F, cv::Scalar(wall_m));
  if (box_m > 0.0F) depth(kBox).setTo(box_m);
  return depth;
}

class FreeSpace : public ::testing::Test {
 protected:
  KeyframeId saw(const cv::Mat& depth, const Pose& cam_from_world = Pose::Identity()) {
    Keyframe keyframe;
    keyframe.id = map_.keyframes.next_id();
    keyframe.cam_from_world = cam_from_world;
    keyframe.nearest_depth = nearest_depths(depth, options_);
    map_.keyframes.put(keyframe);
    asked_.push_back(keyframe.id);
    return keyframe.id;
  }
  cv::Mat moving(const cv::Mat& depth, const Pose& cam_from_world = Pose::Identity()) const {
    return moving_parts(depth, cam_from_world, map_, asked_, guess_camera(320, 240), options_);
  }

  FreeSpaceOptions options_;
  Map map_;
  std::vector<KeyframeId> asked_;
};

TEST_F(FreeSpace, FindsWhatCameBeforeTheWall) {
  saw(wall_with_box(0.0F));
  const cv::Mat found = moving(wall_with_box(1.5F));
  cv::Mat expected(found.size(), CV_8U, cv::Scalar(0));
  expected(kBox).setTo(255);
  EXPECT_EQ(cv::countNonZero(found != expected), 0);
}

TEST_F(FreeSpace, OneKeyframeThatSawThroughIsEnough) {
  saw(wall_with_box(1.5F));
  saw(wall_with_box(0.0F));
  EXPECT_EQ(cv::countNonZero(moving(wall_with_box(1.5F))), kBox.area());
}

TEST_F(FreeSpace, WhatStandsDoesNotMove) {
  saw(wall_with_box(1.5F));
  EXPECT_TRUE(moving(wall_with_box(1.5F)).empty());
}

TEST_F(FreeSpace, OnlyTheCameraMoves) {
  saw(wall_with_box(0.0F));
  Pose nearer = Pose::Identity();
  nearer.translation().z() = -1.0;
  EXPECT_TRUE(moving(wall_with_box(0.0F, kWall - 1.0F), nearer).empty());
}

TEST_F(FreeSpace, WhatUncoversAPlaceAndWhatDiffersByLittleDoesNotMove) {
  saw(wall_with_box(1.5F));
  EXPECT_TRUE(moving(wall_with_box(0.0F)).empty());
  EXPECT_TRUE(moving(wall_with_box(1.5F * 0.93F)).empty());
}

TEST_F(FreeSpace, ReachesFromWhatIsCertainToWhatIsLikely) {
  cv::Mat before = wall_with_box(0.0F);
  const cv::Rect low(kBox.x, kBox.y + 32, kBox.width, 32);
  // Behind the lower half of what comes stands something, hardly further away.
  before(cv::Rect(kBox.x - 16, low.y - 16, kBox.width + 32, low.height + 32)).setTo(1.62);
  saw(before);
  const cv::Mat found = moving(wall_with_box(1.5F));
  EXPECT_EQ(cv::countNonZero(found(kBox)), kBox.area());
  EXPECT_EQ(cv::countNonZero(found), kBox.area());
}

TEST_F(FreeSpace, HolesSayNothing) {
  cv::Mat holes = wall_with_box(0.0F);
  holes(kBox).setTo(0.0);
  saw(holes);
  cv::Mat depth = wall_with_box(0.0F);
  depth(cv::Rect(kBox.x + 16, kBox.y + 16, 24, 24)).setTo(1.5);
  EXPECT_TRUE(moving(depth).empty());
}

}  // namespace
}  // namespace planecast::slam
