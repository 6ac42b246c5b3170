#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "slam/features/matching.h"
#include "slam/features/orb.h"
#include "slam/features/quad_tree.h"

namespace planecast::slam {
namespace {

Camera test_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

/// Seeded rectangles of many sizes and greys: corners everywhere, each with a surrounding of its
/// own.
cv::Mat textured_image(int seed) {
  cv::Mat image(480, 640, CV_8U, cv::Scalar(128));
  cv::RNG random(static_cast<std::uint64_t>(seed));
  for (int i = 0; i < 900; ++i) {
    const cv::Point corner(random.uniform(0, 640), random.uniform(0, 480));
    const cv::Size size(random.uniform(5, 60), random.uniform(5, 60));
    cv::rectangle(image, cv::Rect(corner, size), cv::Scalar(random.uniform(0, 256)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.8);
  return image;
}

TEST(Orb, FindsTheWantedNumberSpreadOverTheImage) {
  OrbExtractor extractor({});
  const Features features = extractor.extract(textured_image(1), test_camera());
  EXPECT_NEAR(features.size(), 1000, 100);
  std::vector<int> per_cell(12, 0);
  for (const Keypoint& keypoint : features.keypoints) {
    ++per_cell[static_cast<std::size_t>(static_cast<int>(keypoint.raw.y()) / 160 * 4 +
                                        static_cast<int>(keypoint.raw.x()) / 160)];
  }
  EXPECT_GT(*std::min_element(per_cell.begin(), per_cell.end()), 30);
}

TEST(Orb, IsTheSameEveryTime) {
  OrbExtractor extractor({});
  const Features a = extractor.extract(textured_image(2), test_camera());
  const Features b = OrbExtractor({}).extract(textured_image(2), test_camera());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.keypoints.size(); ++i) {
    EXPECT_EQ(a.keypoints[i].raw, b.keypoints[i].raw);
    EXPECT_EQ(a.descriptors[i], b.descriptors[i]);
  }
}

TEST(Orb, SurvivesImagesWithoutTextureAndTinyOnes) {
  OrbExtractor extractor({});
  EXPECT_EQ(extractor.extract(cv::Mat(480, 640, CV_8U, cv::Scalar(90)), test_camera()).size(), 0);
  EXPECT_EQ(extractor.extract(cv::Mat(1, 1, CV_8U, cv::Scalar(0)), guess_camera(1, 1)).size(), 0);
}

TEST(Orb, MatchesATurnedImage) {
  // 20 degrees about the centre: most features must find their turned selves.
  const cv::Mat image = textured_image(3);
  const cv::Mat turn = cv::getRotationMatrix2D(cv::Point2f(319.5F, 239.5F), 20.0, 1.0);
  cv::Mat turned;
  cv::warpAffine(image, turned, turn, image.size());
  OrbExtractor extractor({});
  const Features a = extractor.extract(image, test_camera());
  const Features b = extractor.extract(turned, test_camera());
  const auto pairs = match_brute_force(a, {}, b, kStrictDistance, 0.8);
  int right = 0;
  for (const auto& [i, j] : pairs) {
    const Eigen::Vector2f& p = a.keypoints[static_cast<std::size_t>(i)].raw;
    const Eigen::Vector2d expected(
        turn.at<double>(0, 0) * p.x() + turn.at<double>(0, 1) * p.y() + turn.at<double>(0, 2),
        turn.at<double>(1, 0) * p.x() + turn.at<double>(1, 1) * p.y() + turn.at<double>(1, 2));
    right += (b.keypoints[static_cast<std::size_t>(j)].raw.cast<double>() - expected).norm() < 5.0;
  }
  EXPECT_GT(pairs.size(), 150U);
  EXPECT_GT(right, static_cast<int>(0.95 * static_cast<double>(pairs.size())));
}

TEST(QuadTree, KeepsTheStrongestOfACrowd) {
  std::vector<cv::KeyPoint> corners;
  for (int i = 0; i < 50; ++i) {
    corners.emplace_back(cv::Point2f(10.0F + 0.1F * static_cast<float>(i), 10.0F), 7.0F, -1.0F,
                         static_cast<float>(i));
  }
  corners.emplace_back(cv::Point2f(90.0F, 90.0F), 7.0F, -1.0F, 1.0F);
  const auto kept = spread_corners(corners, 100, 100, 2);
  ASSERT_EQ(kept.size(), 2U);
  const auto strongest =
      std::max_element(kept.begin(), kept.end(),
                       [](const auto& a, const auto& b) { return a.response < b.response; });
  EXPECT_EQ(strongest->response, 49.0F);
}

TEST(Grid, FindsExactlyWhatLiesInTheSquare) {
  Features features;
  cv::RNG random(7);
  for (int i = 0; i < 500; ++i) {
    Keypoint keypoint{};
    keypoint.raw.setZero();
    keypoint.pixel = {random.uniform(-20.0F, 660.0F), random.uniform(-20.0F, 500.0F)};
    keypoint.octave = random.uniform(0, 8);
    features.keypoints.push_back(keypoint);
  }
  features.build_grid(640, 480);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d centre(random.uniform(-30.0, 670.0), random.uniform(-30.0, 510.0));
    const double radius = random.uniform(1.0, 80.0);
    std::vector<int> found;
    features.find_in_area(centre, radius, 2, 5, found);
    std::sort(found.begin(), found.end());
    std::vector<int> expected;
    for (int i = 0; i < features.size(); ++i) {
      const Keypoint& keypoint = features.keypoints[static_cast<std::size_t>(i)];
      const Eigen::Vector2d offset = keypoint.pixel.cast<double>() - centre;
      if (keypoint.octave >= 2 && keypoint.octave <= 5 && offset.cwiseAbs().maxCoeff() <= radius) {
        expected.push_back(i);
      }
    }
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace planecast::slam
