#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/evaluate/masks.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

constexpr double kRounding = 1e-12;

/// 20 x 10 pixels; columns [from, to) carry the label.
cv::Mat stripes(const std::vector<std::array<int, 3>>& from_to_label) {
  cv::Mat labels = cv::Mat::zeros(10, 20, CV_16U);
  for (const auto& [from, to, label] : from_to_label) {
    labels.colRange(from, to).setTo(cv::Scalar(label));
  }
  return labels;
}

TEST(Masks, ThemselvesArePerfect) {
  const cv::Mat truth = stripes({{{0, 10, 1}}, {{10, 16, 2}}});
  const MaskScore score = score_masks(truth, truth);
  EXPECT_EQ(score.truth, 2);
  EXPECT_EQ(score.found, 2);
  EXPECT_DOUBLE_EQ(score.partition.rand_index, 1.0);
  EXPECT_NEAR(score.partition.variation_of_information, 0.0, kRounding);
  EXPECT_DOUBLE_EQ(score.partition.segmentation_covering, 1.0);
}

TEST(Masks, NumbersOfInstancesMeanNothing) {
  const cv::Mat truth = stripes({{{0, 10, 1}}, {{10, 16, 2}}});
  const cv::Mat renumbered = stripes({{{0, 10, 200}}, {{10, 16, 7}}});
  const MaskScore score = score_masks(renumbered, truth);
  EXPECT_EQ(score.found, 2);
  EXPECT_DOUBLE_EQ(score.partition.rand_index, 1.0);
}

TEST(Masks, HandComputed) {
  // Truth: 100 pixels of 1, 100 of 2. Estimate: 150 of 5, 50 of 6, borders at columns 10 and 15.
  const cv::Mat truth = stripes({{{0, 10, 1}}, {{10, 20, 2}}});
  const cv::Mat estimate = stripes({{{0, 15, 5}}, {{15, 20, 6}}});
  const MaskScore score = score_masks(estimate, truth);
  // IoU(1, 5) = 100 / 150, IoU(2, 5) = 50 / 200, IoU(2, 6) = 50 / 100: both are found.
  EXPECT_EQ(score.found, 2);
  EXPECT_EQ(score_masks(estimate, truth, {0.6, 0.0}).found, 1);
  const auto pairs = [](double n) { return 0.5 * n * (n - 1.0); };
  const double together = pairs(100) + 2.0 * pairs(50);
  const double disagreeing = 2.0 * pairs(100) + pairs(150) + pairs(50) - 2.0 * together;
  EXPECT_NEAR(score.partition.rand_index, 1.0 - disagreeing / pairs(200), kRounding);
  // H(truth) = ln 2; H(estimate) = ln 4 - 3/4 ln 3; joint {1/2, 1/4, 1/4}: 3/2 ln 2.
  const double voi = 3.0 * std::log(2.0) - std::log(2.0) - (std::log(4.0) - 0.75 * std::log(3.0));
  EXPECT_NEAR(score.partition.variation_of_information, voi, kRounding);
  EXPECT_NEAR(score.partition.segmentation_covering, 0.5 * 2.0 / 3.0 + 0.5 * 0.5, kRounding);
}

TEST(Masks, OnePieceCannotStandForTwoAndSmallOnesNeedNotBeFound) {
  const cv::Mat truth = stripes({{{0, 10, 1}}, {{10, 20, 2}}});
  const MaskScore merged = score_masks(stripes({{{0, 20, 3}}}), truth);
  EXPECT_EQ(merged.truth, 2);
  EXPECT_EQ(merged.found, 1);  // IoU of exactly one half with each, but once
  cv::Mat speck = stripes({{{0, 10, 1}}});
  speck.at<std::uint16_t>(3, 15) = 2;  // half a percent of the picture
  EXPECT_EQ(score_masks(stripes({}), speck, {0.5, 0.01}).truth, 1);
  EXPECT_EQ(score_masks(stripes({}), speck, {0.5, 0.001}).truth, 2);
}

/// Three frames with true masks at 0, 0.1 and 0.2 s.
void write_truth(const TestFolder& folder, const cv::Mat& labels) {
  std::string rgb;
  std::string mask;
  cv::Mat bytes;
  labels.convertTo(bytes, CV_8U);
  fs::create_directories(folder.path() / "rgb");
  fs::create_directories(folder.path() / "mask");
  for (int i = 0; i < 3; ++i) {
    const std::string name = std::to_string(i) + ".png";
    cv::imwrite((folder.path() / "rgb" / name).string(), test_picture(i, 20, 16));
    cv::Mat padded;
    cv::copyMakeBorder(bytes, padded, 0, 6, 0, 0, cv::BORDER_REPLICATE);
    cv::imwrite((folder.path() / "mask" / name).string(), padded);
    rgb += "0." + std::to_string(i) + " rgb/" + name + "\n";
    mask += "0." + std::to_string(i) + " mask/" + name + "\n";
  }
  folder.write("rgb.txt", rgb);
  folder.write("mask.txt", mask);
}

TEST(Masks, FolderAgainstASequence) {
  TestFolder folder;
  write_truth(folder, stripes({{{0, 10, 1}}, {{10, 20, 2}}}));
  fs::create_directories(folder.path() / "estimate");
  // Half the size, 15 ms late, and one frame without.
  const cv::Mat half(8, 10, CV_8U, cv::Scalar(4));
  half.colRange(5, 10).setTo(9);
  cv::imwrite((folder.path() / "estimate/a.png").string(), half);
  folder.write("estimate/mask.txt", "# late\n0.015 a.png\n0.115 a.png\n0.5 a.png\n");
  const auto truth = open_sequence(folder.path(), {});
  const MaskResult result = evaluate_masks(folder.path() / "estimate", *truth);
  EXPECT_EQ(result.frames, 3);
  EXPECT_EQ(result.without_estimate, 1);
  EXPECT_EQ(result.truth, 6);
  EXPECT_EQ(result.found, 4);
  EXPECT_DOUBLE_EQ(result.recall, 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(result.precision, 1.0);
  EXPECT_DOUBLE_EQ(result.rand_index, 1.0);
  EXPECT_EQ(to_json(result).at("found_planes"), 4);
  folder.write("estimate/mask.txt", "7.0 a.png\n");
  EXPECT_NE(user_error([&] {
              evaluate_masks(folder.path() / "estimate", *truth);
            }).find("no mask is within 20 ms"),
            std::string::npos);
}

}  // namespace
}  // namespace planecast::engine
