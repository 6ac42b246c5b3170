#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/core.hpp>

#include "engine/evaluate/image_compare.h"

namespace planecast::engine {
namespace {

cv::Mat noise(int rows, int cols, int type) {
  cv::Mat image(rows, cols, type);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(CompareImages, IdenticalImagesAreIdentical) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
    const cv::Mat image = noise(40, 30, type);
    const ImageDifference difference = compare_images(image, image.clone());
    EXPECT_TRUE(difference.comparable);
    EXPECT_EQ(difference.max_difference, 0);
    EXPECT_EQ(difference.share_beyond, 0.0);
    EXPECT_NEAR(difference.ssim, 1.0, 1e-12);
    EXPECT_TRUE(std::isinf(psnr(image, image)));
  }
}

TEST(CompareImages, OneChangedPixelIsCountedInItsChannel) {
  const cv::Mat expected(10, 20, CV_8UC3, cv::Scalar::all(100));
  cv::Mat actual = expected.clone();
  actual.at<cv::Vec3b>(3, 4) = {100, 110, 95};
  const ImageDifference difference = compare_images(expected, actual, 5);
  EXPECT_EQ(difference.max_by_channel, (std::array<int, 4>{0, 10, 5, 0}));
  EXPECT_EQ(difference.max_difference, 10);
  EXPECT_DOUBLE_EQ(difference.share_beyond, 1.0 / 200.0);
  EXPECT_DOUBLE_EQ(difference.mean_difference, 15.0 / 600.0);
  EXPECT_EQ(compare_images(expected, actual, 10).share_beyond, 0.0);
}

TEST(CompareImages, SsimOfConstantsIsTheLuminanceTerm) {
  const cv::Mat a(32, 32, CV_8UC1, cv::Scalar(100));
  const cv::Mat b(32, 32, CV_8UC1, cv::Scalar(110));
  const double c1 = 0.01 * 255.0 * 0.01 * 255.0;
  EXPECT_NEAR(compare_images(a, b).ssim, (2.0 * 100 * 110 + c1) / (100.0 * 100 + 110 * 110 + c1),
              1e-9);
  EXPECT_NEAR(psnr(a, b), 20.0 * std::log10(25.5), 1e-9);
}

TEST(CompareImages, UnrelatedNoiseHasLowSsim) {
  cv::Mat other = noise(60, 60, CV_8UC3);
  cv::flip(other, other, 1);
  EXPECT_LT(compare_images(noise(60, 60, CV_8UC3), other).ssim, 0.2);
}

TEST(CompareImages, OtherSizeOrTypeIsTheWorst) {
  const ImageDifference difference = compare_images(noise(10, 10, CV_8UC3), noise(10, 11, CV_8UC3));
  EXPECT_FALSE(difference.comparable);
  EXPECT_EQ(difference.share_beyond, 1.0);
  EXPECT_FALSE(compare_images(noise(10, 10, CV_8UC3), noise(10, 10, CV_8UC1)).comparable);
  EXPECT_FALSE(compare_images(cv::Mat(), cv::Mat()).comparable);
}

TEST(CompareImages, DifferencePictureIsAmplified) {
  const cv::Mat expected(4, 4, CV_8UC1, cv::Scalar(100));
  const cv::Mat actual(4, 4, CV_8UC1, cv::Scalar(103));
  const cv::Mat picture = difference_picture(expected, actual, 8.0);
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), cv::Vec3b(24, 24, 24));
}

}  // namespace
}  // namespace planecast::engine
