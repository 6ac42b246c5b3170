#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "engine/sequence/groundtruth.h"
#include "engine/sequence/image_list_sequence.h"
#include "engine/sequence/list_file.h"
#include "engine/sequence/sequence.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

void write_picture(const fs::path& file, const cv::Mat& image) {
  fs::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), image));
}

/// Four images at 10 Hz; depth 15 ms late for the first three, the last without a partner.
void write_tum_folder(const TestFolder& folder) {
  std::string rgb = "# one comment line only\n";
  std::string depth;
  for (int i = 0; i < 4; ++i) {
    write_picture(folder.path() / fmt::format("rgb/{}.png", i), test_picture(i));
    const cv::Mat raw(48, 64, CV_16U, cv::Scalar(1000 * (i + 1)));
    write_picture(folder.path() / fmt::format("depth/{}.png", i), raw);
    rgb += fmt::format("10.{0}00000 rgb/{0}.png\r\n", i);
    depth += fmt::format("10.{0}{1} depth/{0}.png\n", i, i < 3 ? "15" : "50");
  }
  folder.write("rgb.txt", rgb);
  folder.write("depth.txt", depth + "# the end\n");
}

int brightness(const slam::FrameInput& frame) { return frame.image.at<cv::Vec3b>(5, 5)[0]; }

TEST(PairByTime, IsGreedyAndOneToOne) {
  // 0.010 is nearest to 0.009; 0.000 must then take the other one, 0.018 is left to nobody else.
  const std::vector<int> partner = pair_by_time({0.0, 0.01, 5.0}, {0.018, 0.009, 5.021});
  EXPECT_EQ(partner, (std::vector<int>{0, 1, -1}));
}

TEST(NaturalOrder, ComparesRunsOfDigitsAsNumbers) {
  EXPECT_TRUE(natural_less("frame2.png", "frame10.png"));
  EXPECT_FALSE(natural_less("frame10.png", "frame2.png"));
  EXPECT_TRUE(natural_less("a9b2", "a9b10"));
  EXPECT_TRUE(natural_less("007.png", "8.png"));
  EXPECT_FALSE(natural_less("x", "x"));
  EXPECT_TRUE(natural_less("x", "x1"));
}

TEST(TumSequence, PairsDepthAndMasksByTime) {
  TestFolder folder;
  write_tum_folder(folder);
  write_picture(folder.path() / "mask/a.png", cv::Mat(24, 32, CV_8U, cv::Scalar(5)));
  folder.write("mask.txt", "10.199 mask/a.png\n");
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_EQ(sequence->end_frame(), 4);
  EXPECT_NEAR(sequence->fps(), 10.0, 1e-6);
  EXPECT_TRUE(sequence->has_depth());
  EXPECT_TRUE(sequence->has_labels());
  EXPECT_TRUE(sequence->camera().guessed);
  ASSERT_EQ(sequence->warnings().size(), 1u);
  const slam::FrameInput frame = sequence->read(2);
  EXPECT_DOUBLE_EQ(frame.timestamp, 10.2);
  EXPECT_EQ(brightness(frame), 40);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(3, 3), 0.6F);
  ASSERT_EQ(frame.labels.size(), cv::Size(64, 48));  // brought to the images' size
  EXPECT_EQ(frame.labels.at<std::uint16_t>(40, 60), 5);
  EXPECT_TRUE(sequence->read(3).depth.empty());  // 50 ms apart
  EXPECT_TRUE(sequence->read(1).labels.empty());
}

TEST(TumSequence, TakesTheCameraInItsFolderAndResizes) {
  TestFolder folder;
  write_tum_folder(folder);
  folder.write("camera.yaml",
               "width: 128\nheight: 96\nfx: 100\nfy: 101\ncx: 63.5\ncy: 47.5\n"
               "depth_factor: 1000\n");
  SequenceOptions options;
  options.size = cv::Size(32, 24);
  options.first_frame = 1;
  options.end_frame = 3;
  const auto sequence = open_sequence(folder.path(), options);
  EXPECT_EQ(sequence->first_frame(), 1);
  EXPECT_EQ(sequence->end_frame(), 3);
  EXPECT_TRUE(sequence->warnings().empty());
  EXPECT_EQ(sequence->camera().width, 32);
  EXPECT_DOUBLE_EQ(sequence->camera().fx, 25.0);
  EXPECT_DOUBLE_EQ(sequence->camera().cx, 15.5);
  const slam::FrameInput frame = sequence->read(1);
  EXPECT_EQ(frame.image.size(), cv::Size(32, 24));
  EXPECT_EQ(frame.depth.size(), cv::Size(32, 24));
  EXPECT_FLOAT_EQ(frame.depth.at<float>(3, 3), 2.0F);
}

TEST(TumSequence, ErrorsNameTheLine) {
  TestFolder folder;
  write_tum_folder(folder);
  folder.write("rgb.txt", "# a\n10.0 rgb/0.png\nrgb/1.png 10.1\n");
  EXPECT_EQ(user_error([&] { open_sequence(folder.path(), {}); }),
            (folder.path() / "rgb.txt").string() + ":3: expected 'timestamp filename'");
  folder.write("rgb.txt", "# nothing\n");
  EXPECT_NE(user_error([&] { open_sequence(folder.path(), {}); }).find("lists no images"),
            std::string::npos);
  folder.write("rgb.txt", "1 rgb/0.png\n2 rgb/none.png\n3 rgb/big.png\n");
  write_picture(folder.path() / "rgb/big.png", test_picture(0, 128, 96));
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_EQ(user_error([&] { sequence->read(1); }),
            (folder.path() / "rgb/none.png").string() + ": no such file");
  EXPECT_NE(user_error([&] { sequence->read(2); }).find("128x96"), std::string::npos);
}

TEST(ImageFolder, IsInNaturalOrder) {
  TestFolder folder;
  for (int i = 8; i < 12; ++i) {
    write_picture(folder.path() / fmt::format("f{}.bmp", i), test_picture(i));
  }
  folder.write("notes.txt", "not a picture");
  const auto sequence = open_sequence(folder.path(), {});
  ASSERT_EQ(sequence->end_frame(), 4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(brightness(sequence->read(i)), 20 * (i + 8));
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 0.033333);
  EXPECT_FALSE(sequence->has_depth());
  EXPECT_EQ(open_sequence(folder.path() / "f9.bmp", {})->end_frame(), 1);
}

TEST(IclSequence, ReadsAssociations) {
  TestFolder folder;
  for (int i = 0; i < 2; ++i) {
    write_picture(folder.path() / fmt::format("rgb/{}.png", i), test_picture(i));
    write_picture(folder.path() / fmt::format("depth/{}.png", i),
                  cv::Mat(48, 64, CV_16U, cv::Scalar(2500)));
  }
  folder.write("associations.txt", "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n");
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_DOUBLE_EQ(sequence->timestamp(1), 0.033333);
  const slam::FrameInput frame = sequence->read(1);
  EXPECT_EQ(brightness(frame), 20);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(1, 1), 0.5F);
}

TEST(EurocSequence, ReadsCam0) {
  TestFolder folder;
  folder.write(
      "mav0/cam0/data.csv",
      "#timestamp [ns],filename\n1403636579763555584,a.png\n1403636579813555456,b.png\r\n");
  write_picture(folder.path() / "mav0/cam0/data/a.png", test_picture(1));
  write_picture(folder.path() / "mav0/cam0/data/b.png", test_picture(2));
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_NEAR(sequence->timestamp(0), 1403636579.763555584, 1e-6);
  EXPECT_NEAR(sequence->fps(), 20.0, 1e-3);
  EXPECT_EQ(brightness(sequence->read(1)), 40);
}

TEST(OpenSequence, SaysWhatIsWrongWithThePath) {
  TestFolder folder;
  const std::string missing = (folder.path() / "nothing").string();
  EXPECT_EQ(user_error([&] { open_sequence(missing, {}); }), missing + ": no such file or folder");
  EXPECT_NE(
      user_error([&] { open_sequence(folder.path(), {}); }).find("neither rgb.txt nor images"),
      std::string::npos);
  const auto text = folder.write("clip.mp4", "this is no video");
  EXPECT_EQ(user_error([&] { open_sequence(text, {}); }),
            text.string() + ": not a video that FFmpeg can read");
  write_picture(folder.path() / "0.png", test_picture(0));
  SequenceOptions options;
  options.first_frame = 5;
  EXPECT_NE(user_error([&] { open_sequence(folder.path(), options); }).find("no frames in 5:"),
            std::string::npos);
  options.first_frame = 0;
  options.camera = "euroc-cam0";
  EXPECT_NE(user_error([&] { open_sequence(folder.path(), options); }).find("752x480"),
            std::string::npos);
}

class VideoTest : public testing::Test {
 protected:
  void SetUp() override {
    file_ = folder_.path() / "a:clip.mp4";
    cv::VideoWriter writer((folder_.path() / "clip.mp4").string(), cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 25.0, cv::Size(64, 48));
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < 12; ++i) writer.write(test_picture(i));
    writer.release();
    fs::rename(folder_.path() / "clip.mp4", file_);
  }
  TestFolder folder_;
  fs::path file_;
};

TEST_F(VideoTest, EveryFrameInAnyOrder) {
  const auto sequence = open_sequence(file_, {});
  ASSERT_EQ(sequence->end_frame(), 12);
  EXPECT_DOUBLE_EQ(sequence->fps(), 25.0);
  EXPECT_DOUBLE_EQ(sequence->timestamp(3), 0.12);
  // A lossy codec moves a flat value by a few grey levels, far less than the 20 between frames.
  for (const int index : {0, 1, 2, 7, 7, 11, 3, 4, 0}) {
    EXPECT_NEAR(brightness(sequence->read(index)), 20 * index, 8) << index;
  }
}

TEST_F(VideoTest, PartOfIt) {
  SequenceOptions options;
  options.first_frame = 4;
  options.end_frame = 6;
  options.size = cv::Size(32, 24);
  const auto sequence = open_sequence(file_, options);
  EXPECT_EQ(sequence->first_frame(), 4);
  EXPECT_EQ(sequence->end_frame(), 6);
  const slam::FrameInput frame = sequence->read(5);
  EXPECT_EQ(frame.index, 5);
  EXPECT_EQ(frame.image.size(), cv::Size(32, 24));
  EXPECT_EQ(sequence->camera().width, 32);
}

TEST(Groundtruth, ReadsPosesAndNamesBadLines) {
  TestFolder folder;
  const auto file = folder.write("gt.txt", "# c\n1.5 1 2 3 0 0 0.70710678 0.70710678 # turn\n");
  const auto poses = read_trajectory(file);
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].timestamp, 1.5);
  const Eigen::Vector3d p = poses[0].world_from_cam * Eigen::Vector3d(1, 0, 0);
  EXPECT_LT((p - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
  const auto bad = folder.write("bad.txt", "1 2 3 4 0 0 0 1\n1 2 3 nan 0 0 0 1\n");
  EXPECT_NE(user_error([&] { read_trajectory(bad); }).find("bad.txt:2: expected"),
            std::string::npos);
  const auto zero = folder.write("zero.txt", "1 2 3 4 0 0 0 0\n");
  EXPECT_NE(user_error([&] { read_trajectory(zero); }).find("zero.txt:1"), std::string::npos);
}

fs::path real_data() {
  const char* given = std::getenv("PLANECAST_DATA");
  return given != nullptr ? fs::path(given) : fs::path("../shared/data");
}

TEST(RealData, TumOffice) {
  const fs::path folder = real_data() / "sequences/tum_fr3_office_a";
  if (!fs::exists(folder)) GTEST_SKIP() << "no real data in " << real_data();
  SequenceOptions options;
  options.camera = "tum-fr3";
  const auto sequence = open_sequence(folder, options);
  EXPECT_EQ(sequence->end_frame(), 400);
  EXPECT_NEAR(sequence->fps(), 30.0, 2.0);
  EXPECT_EQ(sequence->read(399).image.size(), cv::Size(640, 480));
  EXPECT_GT(read_trajectory(folder / "groundtruth.txt").size(), 400u);
}

TEST(RealData, RedKitchenDepth) {
  const fs::path folder = real_data() / "sequences/redkitchen_a";
  if (!fs::exists(folder)) GTEST_SKIP() << "no real data in " << real_data();
  SequenceOptions options;
  options.camera = "7scenes";
  const auto sequence = open_sequence(folder, options);
  EXPECT_EQ(sequence->end_frame(), 330);
  EXPECT_TRUE(sequence->has_depth());
  double largest_m = 0.0;
  cv::minMaxLoc(sequence->read(100).depth, nullptr, &largest_m);
  EXPECT_GT(largest_m, 1.0);  // a kitchen, and in metres
  EXPECT_LT(largest_m, 10.0);
}

}  // namespace
}  // namespace planecast::engine
