#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "engine/sequence/image_check.h"
#include "engine/sequence/image_file.h"
#include "engine/sequence/labels.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

std::vector<std::uint8_t> encode(const std::string& suffix, const std::vector<int>& options = {}) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(suffix, test_picture(3, 120, 80), bytes, options);
  return bytes;
}

TEST(ImageCheck, PassesWholeFiles) {
  for (const auto& bytes : {encode(".png"), encode(".jpg"), encode(".bmp"),
                            encode(".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
                            encode(".jpg", {cv::IMWRITE_JPEG_RST_INTERVAL, 2})}) {
    const ImageCheck check = check_image_file(bytes);
    EXPECT_TRUE(check.known);
    EXPECT_EQ(check.damage, "");
    EXPECT_EQ(check.width, 120);
    EXPECT_EQ(check.height, 80);
  }
}

TEST(ImageCheck, FindsEveryTruncation) {
  for (const auto& whole : {encode(".png"), encode(".jpg"), encode(".bmp"),
                            encode(".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1})}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::vector<std::uint8_t> part(whole.begin(),
                                           whole.begin() + static_cast<std::ptrdiff_t>(size));
      const ImageCheck check = check_image_file(part);
      // Below its signature's length a file is no image at all, which the decoder says.
      if (size < 8) continue;
      EXPECT_NE(check.damage, "") << size << " of " << whole.size();
    }
  }
}

TEST(ImageCheck, FindsFlippedBitsOfAPng) {
  std::vector<std::uint8_t> bytes = encode(".png");
  for (std::size_t at = 16; at < bytes.size() - 12; at += 7) {
    bytes[at] ^= 0x10;
    EXPECT_NE(check_image_file(bytes).damage, "") << at;
    bytes[at] ^= 0x10;
  }
}

TEST(ImageCheck, NeverReadsPastTheEnd) {
  for (const auto& whole : {encode(".png"), encode(".jpg"), encode(".bmp")}) {
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::vector<std::uint8_t> bytes = whole;
      bytes[at] ^= 0xFF;
      check_image_file(bytes);
    }
  }
}

TEST(ImageFile, TruncatedFilesAreNamed) {
  TestFolder folder;
  for (const std::string suffix : {".png", ".jpg"}) {
    const auto bytes = encode(suffix);
    const auto file = folder.write("cut" + suffix, std::string(bytes.begin(), bytes.end() - 100));
    EXPECT_EQ(user_error([&file] { read_color_image(file); }),
              file.string() + ": the file is cut off");
  }
  const auto text = folder.write("text.png", "this is no picture");
  EXPECT_EQ(user_error([&text] { read_color_image(text); }),
            text.string() + ": is no PNG, JPEG, BMP or TIFF picture");
}

/// Decoders go by the content: what would be taken for another kind is not bounded by our checks.
TEST(ImageFile, OtherKindsAreRefusedWhateverTheirName) {
  TestFolder folder;
  for (const std::string kind : {".ppm", ".webp"}) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(kind, test_picture(1), bytes);
    const auto file = folder.write("named.png", std::string(bytes.begin(), bytes.end()));
    EXPECT_NE(user_error([&file] { read_color_image(file); }).find("is no PNG"), std::string::npos)
        << kind;
  }
}

TEST(ImageCheck, ATiffIsAsLargeAsItsLargestPage) {
  const std::vector<cv::Mat> pages = {test_picture(1, 20, 30), test_picture(2, 50, 10)};
  TestFolder folder;
  const auto file = folder.path() / "pages.tif";
  ASSERT_TRUE(cv::imwrite(file.string(), pages));
  const std::string content = file_bytes(file);
  const std::vector<std::uint8_t> bytes(content.begin(), content.end());
  const ImageCheck check = check_image_file(bytes);
  EXPECT_TRUE(check.known);
  EXPECT_EQ(check.damage, "");
  EXPECT_EQ(check.width, 50);
  EXPECT_EQ(check.height, 30);
  for (std::size_t size = 4; size < bytes.size(); ++size) {
    check_image_file({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
  }
}

/// A decoder may go by the first header, a check by the last.
TEST(ImageCheck, APngHasOneHeader) {
  std::vector<std::uint8_t> bytes = encode(".png");
  constexpr std::ptrdiff_t kSignature = 8;
  constexpr std::ptrdiff_t kHeaderChunk = 25;
  const std::vector<std::uint8_t> header(bytes.begin() + kSignature,
                                         bytes.begin() + kSignature + kHeaderChunk);
  bytes.insert(bytes.begin() + kSignature, header.begin(), header.end());
  EXPECT_NE(check_image_file(bytes).damage, "");
}

TEST(ImageFile, AsManyPixelsAsFourTimes8K) {
  EXPECT_EQ(user_error([] { check_image_size("a", 15360, 8640); }), "");
  EXPECT_NE(user_error([] { check_image_size("a", 16384, 16384); }), "");
  EXPECT_NE(user_error([] { check_image_size("a", 16385, 1); }), "");
}

TEST(ImageFile, AForgedHugeHeaderIsRefused) {
  TestFolder folder;
  std::vector<std::uint8_t> bytes = encode(".jpg");
  for (std::size_t at = 0; at + 9 < bytes.size(); ++at) {
    if (bytes[at] == 0xFF && bytes[at + 1] == 0xC0) bytes[at + 7] = 0xFF;  // width 65400
  }
  const auto file = folder.write("huge.jpg", std::string(bytes.begin(), bytes.end()));
  EXPECT_NE(user_error([&file] { read_color_image(file); }).find("more than 16384"),
            std::string::npos);
}

TEST(ImageFile, DepthInMetresWithHoles) {
  TestFolder folder;
  cv::Mat raw(2, 2, CV_16U);
  raw.at<std::uint16_t>(0, 0) = 5000;
  raw.at<std::uint16_t>(0, 1) = 0;
  raw.at<std::uint16_t>(1, 0) = 65535;
  raw.at<std::uint16_t>(1, 1) = 12345;
  const auto file = folder.path() / "d.png";
  cv::imwrite(file.string(), raw);
  const cv::Mat depth = read_depth_image(file, 5000.0);
  EXPECT_FLOAT_EQ(depth.at<float>(0, 0), 1.0F);
  EXPECT_EQ(depth.at<float>(0, 1), 0.0F);
  EXPECT_EQ(depth.at<float>(1, 0), 0.0F);
  EXPECT_FLOAT_EQ(depth.at<float>(1, 1), 2.469F);
  const auto color = folder.path() / "c.png";
  cv::imwrite(color.string(), test_picture(1));
  EXPECT_NE(user_error([&color] { read_depth_image(color, 5000.0); }).find("16-bit"),
            std::string::npos);
}

TEST(Labels, ColoursAreNumberedInOrderOfAppearance) {
  cv::Mat image = cv::Mat::zeros(2, 3, CV_8UC3);
  image.at<cv::Vec3b>(0, 1) = {9, 9, 200};
  image.at<cv::Vec3b>(0, 2) = {200, 9, 9};
  image.at<cv::Vec3b>(1, 0) = {9, 9, 200};
  const cv::Mat labels = labels_from_image(image);
  const std::vector<std::uint16_t> expected = {0, 1, 2, 1, 0, 0};
  EXPECT_EQ(std::vector<std::uint16_t>(labels.begin<std::uint16_t>(), labels.end<std::uint16_t>()),
            expected);
}

TEST(Labels, GreyValuesAreKept) {
  cv::Mat grey(1, 3, CV_8U);
  grey.at<std::uint8_t>(0, 0) = 0;
  grey.at<std::uint8_t>(0, 1) = 7;
  grey.at<std::uint8_t>(0, 2) = 255;
  const cv::Mat labels = labels_from_image(grey);
  EXPECT_EQ(labels.type(), CV_16U);
  EXPECT_EQ(labels.at<std::uint16_t>(0, 1), 7);
  EXPECT_EQ(labels.at<std::uint16_t>(0, 2), 255);
  EXPECT_TRUE(labels_from_image(cv::Mat::zeros(2, 2, CV_32F)).empty());
}

}  // namespace
}  // namespace planecast::engine
