#include "engine/look/debug_overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <vector>

#include "engine/output/palette.h"
#include "test/unit/engine/table_world.h"

namespace planecast::engine {
namespace {

cv::Mat grey_picture(const Reconstruction& world) {
  return {world.camera.height, world.camera.width, CV_8UC3, cv::Scalar(90, 90, 90)};
}

/// Largest difference of a channel between a plane's colour and the pixels about a point.
double nearest_difference(const cv::Mat& picture, const Eigen::Vector2d& at, int plane) {
  const Rgb rgb = plane_color(plane);
  const cv::Scalar color(rgb[2], rgb[1], rgb[0]);
  double least = 255.0;
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      const auto pixel =
          picture.at<cv::Vec3b>(static_cast<int>(at.y()) + y, static_cast<int>(at.x()) + x);
      double most = 0.0;
      for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(pixel[c] - color[c]));
      least = std::min(least, most);
    }
  }
  return least;
}

TEST(DebugOverlay, OutlinesLieWhereThePlanesAre) {
  const Reconstruction world = table_world();
  cv::Mat picture = grey_picture(world);
  DebugOverlay overlay(world);
  overlay.draw(world.frames[0], false, picture);
  // The middle of the table's far edge.
  const Eigen::Vector2d edge = world.camera.project({0.2, 0.5, 2.0});
  EXPECT_LT(nearest_difference(picture, edge, 1), 12.0);
  // Away from lines and words the picture's own pixels stay.
  EXPECT_EQ(picture.at<cv::Vec3b>(100, 600), cv::Vec3b(90, 90, 90));
}

TEST(DebugOverlay, AFrameWithoutAPoseGetsTheWordsAlone) {
  const Reconstruction world = table_world();
  cv::Mat picture = grey_picture(world);
  DebugOverlay overlay(world);
  overlay.draw(world.frames[1], false, picture);
  const cv::Mat plain = grey_picture(world);
  const int words = picture.rows - 40;
  EXPECT_EQ(cv::norm(picture.rowRange(0, words), plain.rowRange(0, words), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(picture.rowRange(words, picture.rows), plain.rowRange(words, picture.rows),
                     cv::NORM_INF),
            0.0);
}

TEST(DebugOverlay, SameBytesAfterOtherFrames) {
  const Reconstruction world = table_world();
  cv::Mat first = grey_picture(world);
  cv::Mat again = grey_picture(world);
  cv::Mat between = grey_picture(world);
  DebugOverlay overlay(world);
  overlay.draw(world.frames[0], false, first);
  overlay.draw(world.frames[2], false, between);
  overlay.draw(world.frames[0], false, again);
  EXPECT_EQ(cv::norm(first, again, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(first, between, cv::NORM_INF), 0.0);
}

TEST(DebugOverlay, SeveralThreadsDrawTheSame) {
  const Reconstruction world = table_world();
  cv::Mat expected = grey_picture(world);
  DebugOverlay(world).draw(world.frames[0], false, expected);
  std::vector<std::future<double>> differences;
  for (int thread = 0; thread < 4; ++thread) {
    differences.push_back(std::async(std::launch::async, [&] {
      double most = 0.0;
      DebugOverlay overlay(world);
      for (int round = 0; round < 20; ++round) {
        cv::Mat picture = grey_picture(world);
        overlay.draw(world.frames[0], false, picture);
        most = std::max(most, cv::norm(picture, expected, cv::NORM_INF));
      }
      return most;
    }));
  }
  for (std::future<double>& difference : differences) EXPECT_EQ(difference.get(), 0.0);
}

}  // namespace
}  // namespace planecast::engine
