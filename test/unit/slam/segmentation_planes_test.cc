#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "planes_world.h"
#include "slam/geometry/depth_noise.h"
#include "slam/geometry/plane_geometry.h"
#include "slam/segmentation/leaky_masks.h"
#include "slam/segmentation/plane_segmenter.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;

TEST(LabelAt, NeedsAWindowThatAgrees) {
  cv::Mat labels = cv::Mat::zeros(20, 20, CV_16U);
  labels(cv::Rect(5, 5, 10, 10)).setTo(7);
  EXPECT_EQ(label_at(labels, {10.0F, 10.0F}), 7);
  EXPECT_EQ(label_at(labels, {6.4F, 6.4F}), 7);
  EXPECT_EQ(label_at(labels, {5.0F, 10.0F}), 0);
  EXPECT_EQ(label_at(labels, {1.0F, 1.0F}), 0);
  EXPECT_EQ(label_at(labels, {-3.0F, 10.0F}), 0);
  EXPECT_EQ(label_at(labels, {19.0F, 10.0F}), 0);
  EXPECT_EQ(label_at(cv::Mat(), {3.0F, 3.0F}), 0);
}

TEST(MaskSegmenter, GivesTheMasksOfTheFrame) {
  FrameInput frame;
  frame.image = cv::Mat::zeros(20, 30, CV_8U);
  EXPECT_TRUE(make_mask_segmenter()->segment(frame).empty());
  frame.labels = cv::Mat::ones(20, 30, CV_8U) * 3;
  const cv::Mat labels = make_mask_segmenter()->segment(frame);
  ASSERT_EQ(labels.type(), CV_16U);
  EXPECT_EQ(labels.at<ushort>(4, 4), 3);
  EXPECT_TRUE(make_no_segmenter()->segment(frame).empty());
}

TEST(LeakySegmenter, EveryMaskHoldsTheShareOfOthersAsked) {
  FrameInput frame;
  frame.index = 5;
  frame.image = cv::Mat::zeros(120, 160, CV_8U);
  frame.labels = cv::Mat::zeros(120, 160, CV_16U);
  frame.labels(cv::Rect(20, 20, 40, 40)).setTo(1);
  frame.labels(cv::Rect(90, 50, 50, 40)).setTo(2);
  const cv::Mat leaky = make_leaky_segmenter(make_mask_segmenter(), 0.2, 1)->segment(frame);
  for (const int label : {1, 2}) {
    const cv::Mat is = leaky == label;
    const int foreign = cv::countNonZero(is & (frame.labels != label));
    EXPECT_NEAR(foreign, 0.25 * cv::countNonZero(frame.labels == label), 1.0);
    // One blob at the border: it hangs together with what it leaked from.
    cv::Mat parts;
    EXPECT_EQ(cv::connectedComponents(is, parts), 2);
  }
  const cv::Mat again = make_leaky_segmenter(make_mask_segmenter(), 0.2, 1)->segment(frame);
  EXPECT_EQ(cv::countNonZero(again != leaky), 0);
  frame.index = 6;
  const cv::Mat other = make_leaky_segmenter(make_mask_segmenter(), 0.2, 1)->segment(frame);
  EXPECT_GT(cv::countNonZero(other != leaky), 0);
}

/// Depth along z of what each pixel sees first, with the sensor's noise and holes at jumps in
/// depth; `truth` gets the index of the patch.
cv::Mat render_depth(const Camera& camera, std::mt19937& generator, cv::Mat& truth) {
  // Floor, back wall, right wall and a box's front, in the camera's own frame.
  const std::vector<PlaneEquation> room = {{{0, -1, 0}, 1.2}, {{0, 0, -1}, 3.5}, {{-1, 0, 0}, 1.4}};
  std::normal_distribution<double> normal;
  cv::Mat depth(camera.height, camera.width, CV_32F);
  truth = cv::Mat::zeros(camera.height, camera.width, CV_16U);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vector3d ray = camera.ray({static_cast<double>(x), static_cast<double>(y)});
      double z = 1e9;
      for (std::size_t i = 0; i < room.size(); ++i) {
        const auto hit = intersect_ray(room[i], Vector3d::Zero(), ray);
        if (!hit || *hit >= z) continue;
        z = *hit;
        truth.at<ushort>(y, x) = static_cast<ushort>(i + 1);
      }
      const Vector3d on_box = 2.0 * ray;
      if (std::abs(on_box.x() + 0.4) < 0.35 && on_box.y() > 0.3 && on_box.y() < 0.65 && 2.0 < z) {
        z = 2.0;
        truth.at<ushort>(y, x) = 4;
      }
      depth.at<float>(y, x) = static_cast<float>(z + depth_sigma_m(z) * normal(generator));
    }
  }
  return depth;
}

TEST(DepthSegmenter, FindsThePlanesOfANoisyRoom) {
  auto generator = test_generator();
  const Camera camera = test_camera();
  FrameInput frame;
  cv::Mat truth;
  frame.depth = render_depth(camera, generator, truth);
  const cv::Mat labels = make_depth_segmenter(camera)->segment(frame);
  ASSERT_EQ(labels.type(), CV_16U);
  ASSERT_EQ(labels.size(), frame.depth.size());
  std::map<std::pair<int, int>, int> overlap;
  std::map<int, int> truth_size;
  std::map<int, int> label_size;
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const int t = truth.at<ushort>(y, x);
      const int l = labels.at<ushort>(y, x);
      ++truth_size[t];
      if (l == 0) continue;
      ++label_size[l];
      ++overlap[{t, l}];
    }
  }
  for (int t = 1; t <= 4; ++t) {
    double best = 0.0;
    for (const auto& [l, size] : label_size) {
      const double both = overlap[{t, l}];
      best = std::max(best, both / (truth_size[t] + size - both));
    }
    EXPECT_GT(best, 0.85) << "patch " << t;
  }
  EXPECT_EQ(label_size.size(), 4U);
}

TEST(DepthSegmenter, SaysNothingWithoutDepthAndFindsNothingInNoise) {
  const Camera camera = test_camera();
  FrameInput frame;
  EXPECT_TRUE(make_depth_segmenter(camera)->segment(frame).empty());
  frame.depth = cv::Mat::zeros(480, 640, CV_32F);
  EXPECT_EQ(cv::countNonZero(make_depth_segmenter(camera)->segment(frame)), 0);
  auto generator = test_generator();
  std::uniform_real_distribution<float> uniform(0.5F, 4.0F);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) frame.depth.at<float>(y, x) = uniform(generator);
  }
  EXPECT_EQ(cv::countNonZero(make_depth_segmenter(camera)->segment(frame)), 0);
}

}  // namespace
}  // namespace planecast::slam
