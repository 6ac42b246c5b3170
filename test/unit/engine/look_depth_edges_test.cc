#include "engine/look/depth_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace planecast::engine {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr float kNear = 1.0F;
constexpr float kFar = 2.0F;

/// A round thing of one metre before a wall of two.
bool is_near(int y, int x) { return std::hypot(x - 80.0, y - 60.0) < 35.0; }

/// The picture has the true edge; the depth image has it up to three pixels off and a band of
/// holes beside it, as structured light leaves on one side.
void make(cv::Mat& image, cv::Mat& depth) {
  image = cv::Mat(kHeight, kWidth, CV_8UC1);
  depth = cv::Mat(kHeight, kWidth, CV_32FC1);
  cv::RNG rng(3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>((is_near(y, x) ? 150 : 80) + rng.gaussian(4.0));
      const bool measured_near = is_near(y, x + static_cast<int>(std::lround(3.0 * std::sin(y))));
      depth.at<float>(y, x) = measured_near ? kNear : kFar;
      const double r = std::hypot(x - 80.0, y - 60.0);
      if (x < 80 && r > 34.0 && r < 39.0) depth.at<float>(y, x) = 0.0F;
    }
  }
}

/// Share of the pixels within four of the true edge whose surface is the right one.
double right_share(const cv::Mat& depth) {
  int right = 0;
  int all = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (std::abs(std::hypot(x - 80.0, y - 60.0) - 35.0) > 4.0) continue;
      const float z = depth.at<float>(y, x);
      right += z > 0.0F && (z < 1.5F) == is_near(y, x) ? 1 : 0;
      ++all;
    }
  }
  return static_cast<double>(right) / all;
}

TEST(DepthEdges, GoToThePicturesEdges) {
  cv::Mat image;
  cv::Mat depth;
  make(image, depth);
  cv::Mat median;
  cv::medianBlur(depth, median, 5);
  EXPECT_LT(right_share(median), 0.8);
  const cv::Rect whole(0, 0, kWidth, kHeight);
  EXPECT_GT(right_share(refine_depth_edges(depth, image, {whole})), 0.97);
  cv::Mat colour;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  EXPECT_GT(right_share(refine_depth_edges(depth, colour, {whole})), 0.97);
}

TEST(DepthEdges, LeaveSurfacesAlone) {
  cv::Mat image;
  cv::Mat depth;
  make(image, depth);
  cv::Mat slope(kHeight, kWidth, CV_32FC1);
  for (int x = 0; x < kWidth; ++x) slope.col(x).setTo(1.0 + 0.005 * x);
  const cv::Mat refined = refine_depth_edges(slope, image, {cv::Rect(0, 0, kWidth, kHeight)});
  EXPECT_LT(cv::norm(refined, slope, cv::NORM_INF), 0.011);  // the median at the border
  // Outside the region nothing is decided.
  const cv::Mat untouched = refine_depth_edges(depth, image, {cv::Rect()});
  cv::Mat median;
  cv::medianBlur(depth, median, 5);
  EXPECT_EQ(cv::norm(untouched, median, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace planecast::engine
