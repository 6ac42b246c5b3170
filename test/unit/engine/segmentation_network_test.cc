#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/assets.h"
#include "engine/segmentation/choose_segmenter.h"
#include "engine/segmentation/mask_files.h"
#include "engine/segmentation/network_file.h"
#include "engine/sequence/image_file.h"
#include "engine/user_error.h"
#include "network_figures.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

fs::path instances() {
  return fs::path(PLANECAST_SOURCE_DIR) / "test/unit/engine/networks/instances.onnx";
}

class NetworkFile : public ::testing::Test {
 protected:
  /// instances.onnx with a description of its own in a folder of its own.
  fs::path with_description(const std::string& description) {
    const fs::path folder =
        fs::path(::testing::TempDir()) /
        ("network_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::copy_file(instances(), folder / "net.onnx");
    if (!description.empty()) std::ofstream(folder / "net.yaml") << description;
    return folder / "net.onnx";
  }
  static std::string error_of(const fs::path& onnx) {
    try {
      read_network(onnx);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
};

constexpr const char* kInput = "input: {name: image, width: 32, height: 32, mean: [0, 0, 0]}\n";

/// Left half red, right half green, below both a blue stripe. BGR.
cv::Mat flag() {
  cv::Mat picture(60, 80, CV_8UC3, cv::Scalar(0, 0, 255));
  picture.colRange(40, 80).setTo(cv::Scalar(0, 255, 0));
  picture.rowRange(45, 60).setTo(cv::Scalar(255, 0, 0));
  return picture;
}

TEST_F(NetworkFile, InstanceMasksAndScoresBecomeLabels) {
  const auto segmenter = read_network(instances());
  EXPECT_EQ(segmenter->name().substr(0, 25), "network red-green-blue 3 ");
  slam::FrameInput frame;
  frame.image = flag();
  const cv::Mat labels = segmenter->segment(frame);
  ASSERT_EQ(labels.size(), frame.image.size());
  ASSERT_EQ(labels.type(), CV_16U);
  EXPECT_EQ(labels.at<ushort>(20, 20), 1);  // the best score first
  EXPECT_EQ(labels.at<ushort>(20, 60), 2);
  EXPECT_EQ(labels.at<ushort>(52, 30), 0);  // its score is too low
}

TEST_F(NetworkFile, DescriptionSaysOrderOfColoursAndThresholds) {
  slam::FrameInput frame;
  frame.image = flag();
  const fs::path bgr = with_description(
      "kind: instances\nmin_score: 0.05\n"
      "input: {name: image, width: 32, height: 32, colors: bgr, mean: [0, 0, 0]}\n");
  const cv::Mat labels = read_network(bgr)->segment(frame);
  EXPECT_EQ(labels.at<ushort>(52, 30), 1);  // blue comes first now
  EXPECT_EQ(labels.at<ushort>(20, 60), 2);
  EXPECT_EQ(labels.at<ushort>(20, 20), 3);
}

TEST_F(NetworkFile, ErrorsAreOneLineThatNamesTheFile) {
  EXPECT_EQ(error_of("/nowhere/net.onnx"), "/nowhere/net.onnx: cannot be read");
  const fs::path bare = with_description("");
  EXPECT_EQ(error_of(bare), bare.parent_path().string() +
                                "/net.yaml: cannot be read; a network needs its description there");
  const struct {
    std::string description, what;
  } cases[] = {
      {"kind: instances\n", "net.yaml:1: input is missing"},
      {"kind: fish\n" + std::string(kInput), "net.yaml:1: "},
      {"input: {width: 3, height: 32}\n", "net.yaml:1: width of the input"},
      {"input: {width: 32, height: 32, deviation: [1, 0, 1]}\n", "net.yaml:1: deviation"},
      {kInput + std::string("speed: 3\n"), "net.yaml:2: "},
      {kInput + std::string("min_score: 7\n"), "net.yaml:2: min_score: expected 0 to 1"},
      {kInput + std::string("masks: nothing\n"), "net.onnx: "},
      {"input: {name: face, width: 32, height: 32}\n", "net.onnx: "},
      {"kind: maps\noutput: masks\n" + std::string(kInput), "net.onnx: the output has 3 channels"},
  };
  for (const auto& [description, what] : cases) {
    const std::string error = error_of(with_description(description));
    EXPECT_NE(error.find(what), std::string::npos) << description << " -> " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  const fs::path broken = with_description(kInput);
  std::ofstream(broken, std::ios::trunc) << "no network at all";
  EXPECT_NE(error_of(broken).find("net.onnx: is no ONNX network"), std::string::npos)
      << error_of(broken);
}

TEST_F(NetworkFile, OurOwnGivesTheSameLabelsOnOneThreadAndOnTwo) {
  const auto segmenter = choose_network({});
  EXPECT_EQ(segmenter->name().substr(0, 15), "network planes ");
  slam::FrameInput frame;
  frame.image = cv::Mat(480, 640, CV_8UC3);
  cv::RNG random(3);
  random.fill(frame.image, cv::RNG::UNIFORM, 90, 140);
  cv::rectangle(frame.image, {100, 250, 400, 200}, {60, 160, 200}, cv::FILLED);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const cv::Mat one = segmenter->segment(frame);
  cv::setNumThreads(2);
  const cv::Mat two = choose_network({})->segment(frame);
  cv::setNumThreads(threads);
  ASSERT_EQ(one.size(), frame.image.size());
  EXPECT_EQ(cv::countNonZero(one != two), 0);
  // Grey pictures are taken too.
  cv::cvtColor(frame.image, frame.image, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(segmenter->segment(frame).size(), frame.image.size());
}

TEST(PlaneNetwork, DoesOnTwentyHeldOutRoomsWhatIsRecorded) { expect_recorded_figures(20, 0.02); }

TEST(ChooseSegmenter, AutoTakesMasksThenDepthThenNone) {
  const SegmentationChoice automatic;
  EXPECT_EQ(choose_kind(automatic, true, true), "masks");
  EXPECT_EQ(choose_kind(automatic, false, true), "depth");
  EXPECT_EQ(choose_kind(automatic, false, false), "none");
  EXPECT_EQ(choose_kind({"auto", "mine.onnx"}, true, true), "network");
  EXPECT_EQ(choose_kind({"none", {}}, true, true), "none");
}

TEST(MaskFolder, WritesMasksListAndOverlays) {
  const fs::path folder = fs::path(::testing::TempDir()) / "mask_folder";
  fs::remove_all(folder);
  MaskFolder masks(folder, "network planes 2", true);
  const cv::Mat image(12, 16, CV_8U, cv::Scalar(100));
  cv::Mat labels = cv::Mat::zeros(12, 16, CV_16U);
  labels(cv::Rect(4, 4, 8, 8)).setTo(3);
  masks.add(7, 1.5, image, labels);
  masks.add(8, 2.5, image, {});
  EXPECT_EQ(masks.finish(), folder / "mask.txt");
  const cv::Mat read = read_label_image(folder / "mask/000007.png");
  EXPECT_EQ(cv::countNonZero(read != labels), 0);
  EXPECT_EQ(cv::countNonZero(read_label_image(folder / "mask/000008.png")), 0);
  const cv::Mat overlay = read_color_image(folder / "overlay/000007.png");
  EXPECT_EQ(overlay.at<cv::Vec3b>(1, 1), cv::Vec3b(100, 100, 100));
  EXPECT_NE(overlay.at<cv::Vec3b>(7, 7), cv::Vec3b(100, 100, 100));
  std::ifstream list(folder / "mask.txt");
  std::string text{std::istreambuf_iterator<char>(list), {}};
  EXPECT_NE(text.find("by network planes 2"), std::string::npos);
  EXPECT_NE(text.find("1.500000 mask/000007.png"), std::string::npos) << text;
}

}  // namespace
}  // namespace planecast::engine
