#include "engine/sequence/jpeg_file.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

std::vector<std::uint8_t> encode(const cv::Mat& picture, const std::vector<int>& options = {}) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, options);
  return bytes;
}

TEST(Jpeg, GivesTheBytesOfTheGeneralDecoder) {
  for (const auto& bytes : {encode(test_picture(3, 120, 80)), encode(test_picture(4, 37, 51)),
                            encode(test_picture(5, 64, 64), {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
                            encode(test_picture(6, 90, 40), {cv::IMWRITE_JPEG_RST_INTERVAL, 2})}) {
    const cv::Mat expected = cv::imdecode(bytes, cv::IMREAD_COLOR);
    const cv::Mat actual = decode_common_jpeg(bytes);
    ASSERT_EQ(actual.type(), CV_8UC3);
    ASSERT_EQ(actual.size(), expected.size());
    EXPECT_EQ(cv::norm(actual, expected, cv::NORM_INF), 0.0);
  }
}

TEST(Jpeg, LeavesOtherKindsAlone) {
  cv::Mat grey;
  cv::extractChannel(test_picture(3, 120, 80), grey, 0);
  EXPECT_TRUE(decode_common_jpeg(encode(grey)).empty());
  EXPECT_TRUE(decode_common_jpeg({}).empty());
  EXPECT_TRUE(decode_common_jpeg({0x89, 'P', 'N', 'G'}).empty());
  // An EXIF segment, which may turn the picture, after the start of the image.
  std::vector<std::uint8_t> turned = encode(test_picture(3, 120, 80));
  const std::vector<std::uint8_t> exif = {0xFF, 0xE1, 0x00, 0x08, 'E', 'x', 'i', 'f', 0x00, 0x00};
  turned.insert(turned.begin() + 2, exif.begin(), exif.end());
  EXPECT_TRUE(decode_common_jpeg(turned).empty());
}

TEST(Jpeg, DecodesNothingThatIsDamaged) {
  std::vector<std::uint8_t> bytes = encode(test_picture(3, 120, 80));
  bytes.resize(bytes.size() / 2);
  EXPECT_TRUE(decode_common_jpeg(bytes).empty());
}

}  // namespace
}  // namespace planecast::engine
