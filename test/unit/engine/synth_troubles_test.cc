#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "engine/channels.h"
#include "engine/sequence/image_file.h"
#include "engine/sequence/sequence.h"
#include "engine/sequence/synth.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

SynthOptions with_trouble(const std::string& trouble) {
  SynthOptions options;
  options.name = "tabletop";
  options.trouble = trouble;
  options.width = 96;
  options.height = 72;
  options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
  return options;
}

std::unique_ptr<Sequence> make(const SynthOptions& options, const std::filesystem::path& folder) {
  write_synthetic(options, folder, nullptr);
  return open_sequence(folder, {});
}

/// The sequence with its trouble, and without.
struct Both {
  std::unique_ptr<Sequence> with;
  std::unique_ptr<Sequence> without;
};

Both make_both(SynthOptions options, const std::filesystem::path& folder) {
  Both both;
  both.with = make(options, folder / "a");
  options.trouble = "none";
  both.without = make(options, folder / "b");
  return both;
}

double brightness(const cv::Mat& image) { return cv::mean(image)[1]; }

/// Mean absolute second difference along the rows: what blur takes away.
double sharpness(const cv::Mat& image) {
  cv::Mat edges;
  cv::Laplacian(to_grey(image), edges, CV_32F);
  return cv::mean(cv::abs(edges))[0];
}

TEST(SynthTroubles, NoneIsTheSequenceAsItWas) {
  TestFolder folder;
  SynthOptions options = with_trouble("none");
  options.frames = 1;
  make(options, folder.path() / "a");
  options = with_trouble("exposure");
  options.frames = 1;  // before the first jump
  make(options, folder.path() / "b");
  EXPECT_EQ(file_bytes(folder.path() / "a/rgb/0.000000.png"),
            file_bytes(folder.path() / "b/rgb/0.000000.png"));
  options.trouble = "flood";
  EXPECT_NE(user_error([&] {
              write_synthetic(options, folder.path() / "c", nullptr);
            }).find("rolling-shutter"),
            std::string::npos);
}

TEST(SynthTroubles, ExposureJumpsBetweenTwoFrames) {
  TestFolder folder;
  SynthOptions options = with_trouble("exposure");
  options.fps = 10.0;
  options.frames = 13;
  const auto sequence = make(options, folder.path());
  EXPECT_LT(brightness(sequence->read(11).image), 0.8 * brightness(sequence->read(10).image));
  EXPECT_NEAR(brightness(sequence->read(12).image), brightness(sequence->read(11).image), 8.0);
}

TEST(SynthTroubles, AMovingCameraIsBlurred) {
  TestFolder folder;
  SynthOptions options = with_trouble("blur");
  options.width = 320;
  options.height = 240;
  options.fps = 2.0;
  options.frames = 4;
  const auto [blurred, sharp] = make_both(options, folder.path());
  double a = 0.0;
  double b = 0.0;
  for (int i = 0; i < options.frames; ++i) {
    a += sharpness(blurred->read(i).image);
    b += sharpness(sharp->read(i).image);
  }
  EXPECT_LT(a, 0.9 * b);
}

TEST(SynthTroubles, ARollingShutterDiffersButInTheMiddleRows) {
  TestFolder folder;
  SynthOptions options = with_trouble("rolling-shutter");
  options.effects = false;
  options.fps = 1.0;
  options.frames = 3;
  const auto [rolled, global] = make_both(options, folder.path());
  const cv::Mat difference = cv::abs(rolled->read(2).depth - global->read(2).depth);
  const double middle = cv::mean(difference.rowRange(33, 39))[0];
  const double ends =
      cv::mean(difference.rowRange(0, 6))[0] + cv::mean(difference.rowRange(66, 72))[0];
  EXPECT_GT(ends, 2.0 * middle);
}

TEST(SynthTroubles, WhatPassesIsNearAndOfNoPlane) {
  TestFolder folder;
  SynthOptions options = with_trouble("moving");
  options.effects = false;
  options.fps = 4.0;
  options.frames = 10;  // it is in the middle of the view at 2.25 s
  const auto sequence = make(options, folder.path());
  const slam::FrameInput passing = sequence->read(9);
  EXPECT_NEAR(passing.depth.at<float>(36, 48), 1.0F, 0.15F);
  EXPECT_EQ(passing.labels.at<std::uint16_t>(36, 48), 0);
  const slam::FrameInput before = sequence->read(0);
  EXPECT_GT(before.depth.at<float>(36, 48), 1.2F);
}

TEST(SynthTroubles, DroppedFramesLeaveGapsInTime) {
  TestFolder folder;
  SynthOptions options = with_trouble("dropped");
  options.frames = 120;
  options.width = 32;
  options.height = 32;
  const auto sequence = make(options, folder.path());
  EXPECT_GT(sequence->end_frame(), 50);
  EXPECT_LT(sequence->end_frame(), 95);
  double longest = 0.0;
  for (int i = 1; i < sequence->end_frame(); ++i) {
    longest = std::max(longest, sequence->timestamp(i) - sequence->timestamp(i - 1));
  }
  EXPECT_GE(longest, 0.4);
}

}  // namespace
}  // namespace planecast::engine
