#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <set>
#include <vector>

#include "slam/segmentation/decode_planes.h"

namespace planecast::slam {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;

/// A network that is sure of itself: `labels` > 0 are planes with embeddings `apart` from each
/// other, each pixel off by up to `noise`; all normals are the same.
PlaneMaps maps_of(const cv::Mat& labels, float apart, float noise) {
  PlaneMaps maps(labels.rows, labels.cols);
  cv::RNG random(7);
  const auto logit = [](bool holds) { return holds ? 4.0F : -4.0F; };
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const int label = labels.at<ushort>(y, x);
      const int at = y * labels.cols + x;
      const auto differs = [&](int row, int col) {
        return row < labels.rows && col < labels.cols && labels.at<ushort>(row, col) != label;
      };
      maps.planarity()[at] = logit(label > 0);
      maps.right()[at] = logit(differs(y, x + 1));
      maps.down()[at] = logit(differs(y + 1, x));
      maps.normal(2)[at] = -0.5F;
      for (int c = 0; c < PlaneMaps::kEmbedding; ++c) {
        const int steps = label % 4 == c ? 1 + label / 4 : 0;
        maps.embedding(c)[at] = apart * static_cast<float>(steps) + random.uniform(-noise, noise);
      }
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

TEST(PlaneMaps, PutsTheFourValuesOfACellInPlaceAndInterpolatesTheCoarseMaps) {
  constexpr int kCells = 2 * 3;  // 2 rows of 3
  std::vector<float> block(static_cast<std::size_t>(PlaneMaps::kChannels) * kCells);
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = static_cast<float>(i);
  const PlaneMaps maps = PlaneMaps::of(block.data(), 4, 6);
  const auto value = [](int channel, int cell) {
    return static_cast<float>(channel * kCells + cell);
  };
  EXPECT_EQ(maps.planarity()[0], value(0, 0));
  EXPECT_EQ(maps.planarity()[1], value(1, 0));
  EXPECT_EQ(maps.planarity()[6], value(2, 0));
  EXPECT_EQ(maps.planarity()[7], value(3, 0));
  EXPECT_EQ(maps.right()[3 * 6 + 5], value(7, 5));
  EXPECT_EQ(maps.down()[2 * 6 + 2], value(8, 4));
  EXPECT_EQ(maps.normal(0)[0], value(12, 0));
  EXPECT_FLOAT_EQ(maps.embedding(3)[1], value(18, 0) + 0.25F);
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

TEST(DecodePlanes, PartsOneColourBehindABoundaryAlone) {
  // Two planes which the embedding does not tell apart, as where it was learned badly.
  cv::Mat truth(kHeight, kWidth, CV_16U, cv::Scalar(1));
  truth.colRange(kWidth / 2, kWidth).setTo(2);
  PlaneMaps maps = maps_of(truth, 0.0F, 0.1F);
  DecodeOptions options;
  EXPECT_EQ(decode_planes(maps, options).at<ushort>(30, 10),
            decode_planes(maps, options).at<ushort>(30, 80))
      << "alike in all, they are one plane seen in two parts";
  // Normals that differ by a right angle.
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth / 2; x < kWidth; ++x) {
      maps.normal(2)[y * kWidth + x] = 0.0F;
      maps.normal(0)[y * kWidth + x] = 0.7F;
    }
  }
  EXPECT_NE(decode_planes(maps, options).at<ushort>(30, 10),
            decode_planes(maps, options).at<ushort>(30, 80));
}

TEST(DecodePlanes, LosesSmallHolesAndKeepsLargeOnes) {
  cv::Mat truth = room();
  truth(cv::Rect(10, 10, 3, 3)).setTo(0);
  truth(cv::Rect(10, 50, 12, 12)).setTo(0);
  const cv::Mat labels = decode_planes(maps_of(truth, 2.0F, 0.1F));
  EXPECT_EQ(labels.at<ushort>(11, 11), labels.at<ushort>(5, 5));
  EXPECT_EQ(labels.at<ushort>(56, 16), 0);
}

TEST(DecodePlanes, DropsWhatIsTooSmall) {
  cv::Mat truth = room();
  truth(cv::Rect(5, 5, 8, 8)).setTo(4);  // 64 pixels of 6912 are 0.9 %
  DecodeOptions options;
  EXPECT_EQ(decode_planes(maps_of(truth, 2.0F, 0.1F), options).at<ushort>(8, 8), 4);
  options.min_share = 0.02;
  EXPECT_EQ(decode_planes(maps_of(truth, 2.0F, 0.1F), options).at<ushort>(8, 8), 0);
}

TEST(DecodePlanes, FindsNothingWhereNothingIsPlanar) {
  const cv::Mat nothing = cv::Mat::zeros(kHeight, kWidth, CV_16U);
  EXPECT_EQ(cv::countNonZero(decode_planes(maps_of(nothing, 2.0F, 0.0F))), 0);
}

TEST(DecodePlanes, FindsManyInstances) {
  cv::Mat truth(kHeight, kWidth, CV_16U);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      truth.at<ushort>(y, x) = static_cast<ushort>(1 + x / 12 + 8 * (y / 18));
    }
  }
  const cv::Mat labels = decode_planes(maps_of(truth, 3.0F, 0.1F));
  EXPECT_EQ(std::set<ushort>(labels.begin<ushort>(), labels.end<ushort>()).size(), 32U);
  EXPECT_EQ(cv::countNonZero(labels == 0), 0);
}

RegionSums region(float pixels, float embedding) {
  RegionSums sums;
  sums.pixels = pixels;
  sums.planarity = 0.9F * pixels;
  sums.normal = {0.0F, 0.0F, -pixels};
  sums.embedding = {embedding * pixels, 0.0F, 0.0F, 0.0F};
  return sums;
}

TEST(RegionGraph, MergesTheCheapestBordersFirstAndStopsInTime) {
  RegionGraph graph({region(10, 0.0F), region(10, 0.0F), region(10, 3.0F), region(10, 0.0F)});
  graph.add_border(0, 1, 0.1F);
  graph.add_border(1, 2, 0.1F);
  graph.add_border(0, 3, 0.9F);
  MergeCosts costs;
  costs.embedding = 0.25F;
  costs.most = 0.6F;
  graph.merge(costs);
  EXPECT_EQ(graph.root(0), graph.root(1));
  EXPECT_NE(graph.root(1), graph.root(2));  // 0.1 + 0.25 x 3
  EXPECT_NE(graph.root(0), graph.root(3));  // a strong border
  EXPECT_FLOAT_EQ(graph.sums(graph.root(0)).pixels, 20.0F);
}

TEST(RegionGraph, AveragesABorderOverItsLength) {
  RegionGraph graph({region(10, 0.0F), region(10, 0.0F)});
  graph.add_border(0, 1, 1.0F);  // one strong step
  for (int i = 0; i < 9; ++i) graph.add_border(0, 1, 0.0F);
  graph.merge({});
  EXPECT_EQ(graph.root(0), graph.root(1));
}

}  // namespace
}  // namespace planecast::slam
