#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "engine/evaluate/image_compare.h"
#include "engine/output/libav.h"
#include "engine/output/video.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

/// A smooth coloured pattern with moving discs: what H.264 at crf 20 keeps well above 35 dB.
cv::Mat picture(int frame, cv::Size size) {
  cv::Mat image(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<uchar>(60 + 100 * x / size.width),
                    static_cast<uchar>(50 + 120 * y / size.height), static_cast<uchar>(90));
    }
  }
  const int side = size.width;
  cv::circle(image, {(7 * frame) % side, size.height / 2}, size.height / 5, {200, 180, 60}, -1,
             cv::LINE_AA);
  cv::GaussianBlur(image, image, {0, 0}, 2.0);
  return image;
}

void write_video(const fs::path& path, int frames, cv::Size size, const VideoOptions& options,
                 double fps = 30.0) {
  VideoWriter writer(path, size.width, size.height, fps, options);
  for (int i = writer.first_missing_frame(); i < frames; ++i) writer.write(picture(i, size));
  writer.finish();
}

std::vector<cv::Mat> decode(const fs::path& path) {
  cv::VideoCapture capture(path.string(), cv::CAP_FFMPEG);
  std::vector<cv::Mat> frames;
  for (cv::Mat frame; capture.read(frame);) frames.push_back(frame.clone());
  return frames;
}

VideoOptions short_segments() {
  VideoOptions options;
  options.segment_frames = 10;
  return options;
}

TEST(VideoWriter, EveryFrameComesBackInOrderAndSharp) {
  const TestFolder folder;
  const cv::Size size(160, 120);
  write_video(folder / "augmented.mp4", 33, size, short_segments());
  const std::vector<cv::Mat> frames = decode(folder / "augmented.mp4");
  ASSERT_EQ(frames.size(), 33U);
  for (int i = 0; i < 33; ++i) {
    EXPECT_GT(psnr(picture(i, size), frames[static_cast<std::size_t>(i)]), 35.0) << "frame " << i;
  }
  EXPECT_FALSE(fs::exists(folder / "segments"));
  cv::VideoCapture capture((folder / "augmented.mp4").string(), cv::CAP_FFMPEG);
  EXPECT_NEAR(capture.get(cv::CAP_PROP_FPS), 30.0, 1e-9);
  EXPECT_EQ(capture.get(cv::CAP_PROP_FRAME_COUNT), 33.0);
}

/// Presentation times in seconds, ascending.
std::vector<double> presentation_times(const fs::path& path) {
  AVFormatContext* context = nullptr;
  EXPECT_EQ(avformat_open_input(&context, path.c_str(), nullptr, nullptr), 0);
  const libav::Input input(context);
  const libav::Packet packet(av_packet_alloc());
  std::vector<double> times;
  std::int64_t last_dts = std::numeric_limits<std::int64_t>::min();
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    EXPECT_GT(packet->dts, last_dts);
    EXPECT_LE(packet->dts, packet->pts);
    last_dts = packet->dts;
    times.push_back(static_cast<double>(packet->pts) * av_q2d(input->streams[0]->time_base));
    av_packet_unref(packet.get());
  }
  std::sort(times.begin(), times.end());
  return times;
}

TEST(VideoWriter, TimesOfFramesAreExactAcrossSegments) {
  const TestFolder folder;
  // 21 frames: the last segment has one, which x264 orders differently from a full one.
  for (const double fps : {25.0, 30000.0 / 1001.0}) {
    write_video(folder / "augmented.mp4", 21, {64, 48}, short_segments(), fps);
    const std::vector<double> times = presentation_times(folder / "augmented.mp4");
    ASSERT_EQ(times.size(), 21U);
    for (std::size_t i = 0; i < times.size(); ++i) {
      EXPECT_NEAR(times[i], static_cast<double>(i) / fps, 1e-9);
    }
  }
}

TEST(VideoWriter, SameFramesGiveTheSameBytes) {
  const TestFolder folder;
  write_video(folder / "a.mp4", 25, {160, 120}, short_segments());
  write_video(folder / "b.mp4", 25, {160, 120}, short_segments());
  EXPECT_TRUE(read_file(folder / "a.mp4") == read_file(folder / "b.mp4"));
}

TEST(VideoWriter, ResumedRunGivesTheSameBytes) {
  const TestFolder folder;
  const cv::Size size(96, 64);
  write_video(folder / "whole.mp4", 35, size, short_segments());
  {
    VideoWriter killed(folder / "augmented.mp4", size.width, size.height, 30.0, short_segments());
    for (int i = 0; i < 27; ++i) killed.write(picture(i, size));
  }
  EXPECT_FALSE(fs::exists(folder / "augmented.mp4"));
  EXPECT_EQ(decode(folder.path() / "segments" / "000001.mp4").size(), 10U);
  VideoOptions options = short_segments();
  options.resume = true;
  {
    const VideoWriter resumed(folder / "augmented.mp4", size.width, size.height, 30.0, options);
    EXPECT_EQ(resumed.first_missing_segment(), 2);
    EXPECT_EQ(resumed.first_missing_frame(), 20);
  }
  write_video(folder / "augmented.mp4", 35, size, options);
  EXPECT_TRUE(read_file(folder / "whole.mp4") == read_file(folder / "augmented.mp4"));
}

TEST(VideoWriter, SegmentsOfOtherSettingsAreNotResumed) {
  const TestFolder folder;
  {
    VideoWriter killed(folder / "augmented.mp4", 64, 48, 30.0, short_segments());
    for (int i = 0; i < 12; ++i) killed.write(picture(i, {64, 48}));
  }
  VideoOptions options = short_segments();
  options.resume = true;
  options.content_key = "another scene";
  const VideoWriter writer(folder / "augmented.mp4", 64, 48, 30.0, options);
  EXPECT_EQ(writer.first_missing_segment(), 0);
}

TEST(VideoWriter, FilesOfOthersInTheSegmentsFolderSurvive) {
  const TestFolder folder;
  make_folder(folder / "segments");
  write_file(folder.path() / "segments" / "mine.txt", "keep");
  write_video(folder / "augmented.mp4", 3, {64, 48}, short_segments());
  EXPECT_EQ(read_file(folder.path() / "segments" / "mine.txt"), "keep");
}

TEST(VideoWriter, OddSizesArePaddedToEven) {
  const TestFolder folder;
  const cv::Size size(65, 47);
  write_video(folder / "augmented.mp4", 3, size, {});
  const std::vector<cv::Mat> frames = decode(folder / "augmented.mp4");
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].size(), cv::Size(66, 48));
  EXPECT_GT(psnr(picture(0, size), frames[0](cv::Rect({0, 0}, size)).clone()), 35.0);
}

TEST(VideoWriter, OneFrameIsAVideo) {
  const TestFolder folder;
  write_video(folder / "augmented.mp4", 1, {64, 48}, {});
  EXPECT_EQ(decode(folder / "augmented.mp4").size(), 1U);
}

TEST(VideoWriter, FailuresNameTheFile) {
  const TestFolder folder;
  write_file(folder / "file", "x");
  const auto video = folder / "augmented.mp4";
  for (const std::string& error : {
           user_error_of([&] { VideoWriter(video, 0, 48, 30.0); }),
           user_error_of([&] { VideoWriter(video, 64, 48, 0.0); }),
           user_error_of([&] { VideoWriter(video, 64, 48, std::nan("")); }),
           user_error_of([&] { VideoWriter(video, 64, 48, 30.0).finish(); }),
       }) {
    EXPECT_NE(error.find("augmented.mp4"), std::string::npos) << error;
  }
  EXPECT_FALSE(
      user_error_of([&] { VideoWriter(folder / "file" / "a.mp4", 64, 48, 30.0); }).empty());
}

TEST(FrameRate, NtscRatesAndThousandths) {
  const auto rate = [](double fps) {
    const FrameRate exact = exact_frame_rate(fps);
    return std::pair{exact.numerator, exact.denominator};
  };
  EXPECT_EQ(rate(30.0), std::pair(30, 1));
  EXPECT_EQ(rate(29.97), std::pair(30000, 1001));
  EXPECT_EQ(rate(23.976), std::pair(24000, 1001));
  EXPECT_EQ(rate(12.5), std::pair(25, 2));
  EXPECT_EQ(rate(30.2124), std::pair(7553, 250));  // 30.212
}

}  // namespace
}  // namespace planecast::engine
