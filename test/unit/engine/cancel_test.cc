#include "engine/cancel.h"

#include <gtest/gtest.h>

#include "engine/pipeline/resume_tracking.h"
#include "engine/pipeline/track_sequence.h"
#include "engine/sequence/synth.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

/// Takes the request back whatever a test does.
struct CancelGuard {
  ~CancelGuard() { clear_cancel(); }
};

std::unique_ptr<Sequence> make_sequence(const std::filesystem::path& folder) {
  SynthOptions options;
  options.name = "tabletop";
  options.width = 160;
  options.height = 120;
  options.frames = 12;
  options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
  write_synthetic(options, folder, nullptr);
  return open_sequence(folder, {});
}

TEST(Cancel, IsThrownOnceAskedFor) {
  const CancelGuard guard;
  EXPECT_NO_THROW(throw_if_cancelled());
  request_cancel();
  EXPECT_THROW(throw_if_cancelled(), Cancelled);
  clear_cancel();
  EXPECT_FALSE(cancel_requested());
}

TEST(Cancel, TrackingEndsAfterItsFrameAndKeepsWhatWasDone) {
  const CancelGuard guard;
  TestFolder folder;
  const auto sequence = make_sequence(folder.path() / "sequence");
  TrackSequenceOptions options;
  options.mode = "rgbd";
  const Reconstruction reconstruction = track_sequence(*sequence, options, [](int done, int) {
    if (done == 5) request_cancel();
  });
  EXPECT_EQ(reconstruction.frames.size(), 5u);
  EXPECT_TRUE(was_interrupted(reconstruction));
  EXPECT_TRUE(reconstruction.frames.back().world_from_cam.has_value());
  EXPECT_THROW(require_complete(reconstruction), Cancelled);

  // What is not complete is written, but not resumed from.
  write_tracked(reconstruction, *sequence, options, folder.path() / "out");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / "map.bin"));
  EXPECT_FALSE(is_tracked(*sequence, options, folder.path() / "out"));
}

/// What an earlier run left is worth more than nothing.
TEST(Cancel, WithoutOneFrameNothingIsWritten) {
  const CancelGuard guard;
  TestFolder folder;
  const auto sequence = make_sequence(folder.path() / "sequence");
  const TrackSequenceOptions options;
  request_cancel();
  const Reconstruction reconstruction = track_sequence(*sequence, options, nullptr);
  EXPECT_THROW(write_tracked(reconstruction, *sequence, options, folder.path() / "out"), Cancelled);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(Cancel, OnlyTheSameTrackingIsResumed) {
  TestFolder folder;
  const auto sequence = make_sequence(folder.path() / "sequence");
  TrackSequenceOptions options;
  options.mode = "rgbd";
  const std::filesystem::path out = folder.path() / "out";
  write_tracked(track_sequence(*sequence, options, nullptr), *sequence, options, out);
  EXPECT_TRUE(is_tracked(*sequence, options, out));
  options.threads = 1;
  EXPECT_TRUE(is_tracked(*sequence, options, out));
  options.seed = 2;
  EXPECT_FALSE(is_tracked(*sequence, options, out));
  options.seed = 1;
  options.mode = "mono";
  EXPECT_FALSE(is_tracked(*sequence, options, out));
  options.mode = "rgbd";
  SequenceOptions shorter;
  shorter.end_frame = 6;
  EXPECT_FALSE(is_tracked(*open_sequence(folder.path() / "sequence", shorter), options, out));
}

}  // namespace
}  // namespace planecast::engine
