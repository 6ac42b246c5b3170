#include "engine/pipeline/picture_flow.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine/pipeline/painting_threads.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// Frames without content, of which one cannot be read.
class NumberedSequence : public Sequence {
 public:
  explicit NumberedSequence(int unreadable) : unreadable_(unreadable) {}
  int first_frame() const override { return 0; }
  int end_frame() const override { return 50; }
  double timestamp(int index) const override { return index; }
  slam::FrameInput read(int index) override {
    if (index == unreadable_) throw UserError("frame broken");
    if (index == 40) throw std::runtime_error("disk on fire");
    slam::FrameInput frame;
    frame.index = index;
    return frame;
  }
  bool has_depth() const override { return false; }
  bool has_labels() const override { return false; }
  const slam::Camera& camera() const override { return camera_; }
  double fps() const override { return 30.0; }
  std::string name() const override { return "numbers"; }
  std::filesystem::path path() const override { return "numbers"; }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  int unreadable_;
  slam::Camera camera_;
  std::vector<std::string> warnings_;
};

class PictureFlow : public ::testing::TestWithParam<bool> {};

TEST_P(PictureFlow, FramesComeInOrderAndBadOnesSayWhy) {
  NumberedSequence sequence(7);
  FrameReader reader(sequence, 3, 30, GetParam());
  for (int index = 3; index < 30; ++index) {
    const std::optional<ReadFrame> frame = reader.next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->index, index);
    EXPECT_EQ(frame->error, index == 7 ? "frame broken" : "");
  }
  EXPECT_FALSE(reader.next().has_value());
}

TEST_P(PictureFlow, FramesComeBackwardsToo) {
  NumberedSequence sequence(7);
  FrameReader reader(sequence, 9, 4, GetParam(), -1);
  for (int index = 9; index > 4; --index) {
    const std::optional<ReadFrame> frame = reader.next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->index, index);
    EXPECT_EQ(frame->error.empty(), index != 7);
  }
  EXPECT_FALSE(reader.next().has_value());
}

TEST_P(PictureFlow, OtherFailuresArriveWhereFramesAreTaken) {
  NumberedSequence sequence(-1);
  FrameReader reader(sequence, 38, 50, GetParam());
  const auto take_all = [&reader] {
    while (reader.next()) continue;
  };
  EXPECT_THROW(take_all(), std::runtime_error);
}

TEST_P(PictureFlow, AReaderMayBeLeftEarly) {
  NumberedSequence sequence(-1);
  FrameReader reader(sequence, 0, 39, GetParam());
  EXPECT_TRUE(reader.next().has_value());
}

TEST_P(PictureFlow, PicturesAreWrittenInOrder) {
  std::vector<int> written;
  PictureWriter writer([&written](const Picture& picture) { written.push_back(picture.index); },
                       GetParam());
  for (int index = 0; index < 40; ++index) writer.put({index, cv::Mat()});
  writer.finish();
  ASSERT_EQ(written.size(), 40U);
  for (int index = 0; index < 40; ++index)
    EXPECT_EQ(written[static_cast<std::size_t>(index)], index);
}

TEST_P(PictureFlow, FailuresOfWritingArriveAtTheLatestAtTheEnd) {
  const auto write = [](const Picture& picture) {
    if (picture.index == 3) throw UserError("disk full");
  };
  const auto write_all = [&] {
    PictureWriter writer(write, GetParam());
    for (int index = 0; index < 20; ++index) writer.put({index, cv::Mat()});
    writer.finish();
  };
  EXPECT_THROW(write_all(), UserError);
}

/// Three painting threads, or the caller's own.
TEST_P(PictureFlow, FramesArePaintedInOrderWhoeverPaintsThem) {
  std::atomic<int> made = 0;
  const auto make = [&made]() -> PaintingThreads::Paint {
    ++made;
    return [](const ReadFrame& frame) {
      // The first of each three is the slowest.
      std::this_thread::sleep_for(std::chrono::milliseconds(frame.index % 3 == 0 ? 5 : 0));
      PaintedFrame painted;
      painted.index = frame.index;
      return painted;
    };
  };
  const int threads = GetParam() ? 3 : 1;
  PaintingThreads painters(make, threads);
  int next = 0;
  int taken = 0;
  while (taken < 20) {
    for (; next < 20 && !painters.full(); ++next) {
      ReadFrame frame;
      frame.index = next;
      painters.put(std::move(frame));
    }
    EXPECT_EQ(painters.take().index, taken++);
  }
  EXPECT_TRUE(painters.empty());
  EXPECT_EQ(made.load(), threads);
}

TEST_P(PictureFlow, FailuresOfPaintingArriveWithTheirFrame) {
  const auto make = []() -> PaintingThreads::Paint {
    return [](const ReadFrame& frame) -> PaintedFrame {
      if (frame.index == 1) throw UserError("no more paint");
      return {};
    };
  };
  const auto paint_two = [&] {
    PaintingThreads painters(make, GetParam() ? 2 : 1);
    for (int i = 0; i < 2; ++i) {
      ReadFrame frame;
      frame.index = i;
      painters.put(std::move(frame));
      painters.take();
    }
  };
  EXPECT_THROW(paint_two(), UserError);
}

INSTANTIATE_TEST_SUITE_P(Threads, PictureFlow, ::testing::Bool());

}  // namespace
}  // namespace planecast::engine
