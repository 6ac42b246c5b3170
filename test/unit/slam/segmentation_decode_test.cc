#include <gtest/gtest.h>

#include <set>

#include "slam/segmentation/decode_planes.h"

namespace planecast::slam {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;

/// A network that is sure of itself: `labels` > 0 are planes with embeddings `apart` from each
/// other, each pixel off by up to `noise`.
PlaneMaps maps_of(const cv::Mat& labels, float apart, float noise) {
  PlaneMaps maps;
  maps.planarity = cv::Mat(labels.size(), CV_32F, cv::Scalar(-4.0));
  maps.boundary = cv::Mat(labels.size(), CV_32F, cv::Scalar(-4.0));
  for (cv::Mat& map : maps.embedding) map = cv::Mat::zeros(labels.size(), CV_32F);
  cv::RNG random(7);
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const int label = labels.at<ushort>(y, x);
      if (label == 0) continue;
      maps.planarity.at<float>(y, x) = 4.0F;
      for (int c = 0; c < 4; ++c) {
        const int steps = label % 4 == c ? 1 + label / 4 : 0;
        maps.embedding[static_cast<std::size_t>(c)].at<float>(y, x) =
            apart * static_cast<float>(steps) + random.uniform(-noise, noise);
      }
      const bool edge = (x > 0 && labels.at<ushort>(y, x - 1) != label) ||
                        (y > 0 && labels.at<ushort>(y - 1, x) != label);
      if (edge) maps.boundary.at<float>(y, x) = 4.0F;
    }
  }
  return maps;
}

/// Floor, wall, a box on the floor and something that is not flat.
cv::Mat room() {
  cv::Mat labels(kHeight, kWidth, CV_16U, cv::Scalar(1));
  labels(cv::Rect(0, 0, kWidth, 30)).setTo(2);
  labels(cv::Rect(40, 40, 12, 10)).setTo(3);
  labels(cv::Rect(70, 20, 20, 40)).setTo(0);
  return labels;
}

TEST(DecodePlanes, FindsInstancesBySizeAndLeavesOutWhatIsNotPlanar) {
  const cv::Mat truth = room();
  const cv::Mat labels = decode_planes(maps_of(truth, 2.0F, 0.3F));
  ASSERT_EQ(labels.type(), CV_16U);
  ASSERT_EQ(labels.size(), truth.size());
  // By falling size the floor is 1, the wall 2, the box 3, as they are in the truth.
  EXPECT_EQ(cv::countNonZero(labels != truth), 0);
}

TEST(DecodePlanes, KeepsAPlaneThatIsSeenInTwoPartsWhole) {
  cv::Mat truth = room();
  truth(cv::Rect(30, 30, 10, kHeight - 30)).setTo(0);  // cuts the floor
  const cv::Mat labels = decode_planes(maps_of(truth, 2.0F, 0.2F));
  EXPECT_EQ(labels.at<ushort>(60, 10), labels.at<ushort>(60, 60));
  EXPECT_NE(labels.at<ushort>(60, 10), 0);
}

TEST(DecodePlanes, DropsWhatIsTooSmall) {
  cv::Mat truth = room();
  truth(cv::Rect(5, 5, 3, 3)).setTo(4);  // 9 pixels of 6912 are 0.13 %
  DecodeOptions options;
  const cv::Mat labels = decode_planes(maps_of(truth, 2.0F, 0.1F), options);
  EXPECT_EQ(labels.at<ushort>(6, 6), 0);
  options.min_share = 0.001;
  EXPECT_EQ(decode_planes(maps_of(truth, 2.0F, 0.1F), options).at<ushort>(6, 6), 4);
}

TEST(DecodePlanes, FindsNothingWhereNothingIsPlanar) {
  const cv::Mat nothing = cv::Mat::zeros(kHeight, kWidth, CV_16U);
  EXPECT_EQ(cv::countNonZero(decode_planes(maps_of(nothing, 2.0F, 0.0F))), 0);
}

TEST(DecodePlanes, TakesNoMoreInstancesThanSeeds) {
  cv::Mat truth(kHeight, kWidth, CV_16U);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      truth.at<ushort>(y, x) = static_cast<ushort>(1 + x / 12 + 8 * (y / 18));
    }
  }
  DecodeOptions options;
  options.seeds = 10;
  const cv::Mat labels = decode_planes(maps_of(truth, 3.0F, 0.1F), options);
  const std::set<ushort> found(labels.begin<ushort>(), labels.end<ushort>());
  EXPECT_EQ(found.size() - found.count(0), 10U);
  options.seeds = 40;
  EXPECT_EQ(cv::countNonZero(decode_planes(maps_of(truth, 3.0F, 0.1F), options) == 0), 0);
}

}  // namespace
}  // namespace planecast::slam
