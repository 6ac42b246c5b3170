// slam::System over whole scenes of the generator: what takes too long for the quick tests.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/sequence/groundtruth.h"
#include "engine/sequence/sequence.h"
#include "engine/sequence/synth.h"
#include "slam/system.h"

namespace planecast {
namespace {

namespace fs = std::filesystem;

/// Where scenes are kept as long as the tests run.
struct SceneFolder {
  fs::path path = fs::temp_directory_path() / ("planecast_system_test_" + std::to_string(getpid()));
  ~SceneFolder() { fs::remove_all(path); }
};

/// A scene of the generator, made once for all tests.
std::unique_ptr<engine::Sequence> scene(const std::string& name, double fps, int frames = -1) {
  static const SceneFolder scenes;
  const fs::path folder = scenes.path / name;
  if (!fs::exists(folder / "planes.json")) {
    engine::SynthOptions options;
    options.name = name;
    options.width = 320;
    options.height = 240;
    options.fps = fps;
    options.frames = frames;
    options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
    engine::write_synthetic(options, folder, nullptr);
  }
  return engine::open_sequence(folder, {});
}

slam::SystemOptions options_for(bool rgbd) {
  slam::SystemOptions options;
  options.rgbd = rgbd;
  std::ifstream in(std::string(PLANECAST_SOURCE_DIR) + "/assets/vocabulary/orb.bin",
                   std::ios::binary);
  options.vocabulary = std::make_shared<const slam::Vocabulary>(*slam::Vocabulary::read(in));
  return options;
}

/// Tracks the whole sequence as the pipeline does.
std::vector<slam::FrameTrack> track_all(engine::Sequence& sequence, slam::System& system) {
  std::vector<slam::FrameTrack> tracks;
  for (int i = sequence.first_frame(); i < sequence.end_frame(); ++i) {
    tracks.push_back(system.track(system.prepare(sequence.read(i), system.initialised())));
  }
  return tracks;
}

class LoopThroughTheSystem : public ::testing::TestWithParam<bool> {};

TEST_P(LoopThroughTheSystem, IsVisibleExactlyWhenItIsDue) {
  const auto ring = scene("ring", 15.0);
  const slam::SystemOptions options = options_for(GetParam());
  slam::System system(options, ring->camera(), slam::make_no_segmenter());
  const std::vector<slam::FrameTrack> tracks = track_all(*ring, system);
  std::set<int> keyframes;
  std::vector<int> closed;
  for (int i = 0; i < static_cast<int>(tracks.size()); ++i) {
    if (tracks[static_cast<std::size_t>(i)].keyframe) keyframes.insert(i);
    if (tracks[static_cast<std::size_t>(i)].loop_closed) closed.push_back(i);
  }
  ASSERT_FALSE(closed.empty());
  for (const int frame : closed) {
    // Where keyframes were due at that very frame, the loop comes one after the other.
    const bool due = keyframes.count(frame - options.loop_delay) > 0 ||
                     keyframes.count(frame - options.loop_delay - 1) > 0;
    EXPECT_TRUE(due) << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(MonoAndDepth, LoopThroughTheSystem, ::testing::Bool());

class LossAndReturn : public ::testing::TestWithParam<bool> {};

TEST_P(LossAndReturn, RelocalisesWithinTenFrames) {
  const auto sequence = scene("tracking-loss", 30.0);
  slam::System system(options_for(GetParam()), sequence->camera(), slam::make_no_segmenter());
  const std::vector<slam::FrameTrack> tracks = track_all(*sequence, system);
  // The scene shows a blank wall for its middle part; where it comes back can be seen in the grey
  // values.
  std::vector<bool> blank;
  for (int i = sequence->first_frame(); i < sequence->end_frame(); ++i) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(sequence->read(i).image, mean, deviation);
    blank.push_back(deviation[0] < 12.0);
  }
  int returned = -1;
  for (std::size_t i = 1; i < blank.size(); ++i) {
    if (blank[i - 1] && !blank[i]) returned = static_cast<int>(i);
  }
  ASSERT_GT(returned, 0);
  int tracked = returned;
  while (tracked < static_cast<int>(tracks.size()) &&
         tracks[static_cast<std::size_t>(tracked)].state != slam::TrackState::kTracked) {
    ++tracked;
  }
  EXPECT_LE(tracked - returned, 10);
}

INSTANTIATE_TEST_SUITE_P(MonoAndDepth, LossAndReturn, ::testing::Bool());

TEST(Start, AStandingCameraDoesNotStart) {
  const auto sequence = scene("tabletop", 30.0, 60);
  slam::System system(options_for(false), sequence->camera(), slam::make_no_segmenter());
  slam::FrameInput frame = sequence->read(0);
  cv::RNG noise(7);
  for (int i = 0; i < 120; ++i) {
    // The sensor's noise is another in each frame.
    slam::FrameInput again = frame;
    cv::Mat grain(frame.image.size(), CV_16SC3);
    noise.fill(grain, cv::RNG::NORMAL, 0.0, 3.0);
    cv::add(frame.image, grain, again.image, cv::noArray(), CV_8UC3);
    again.index = i;
    again.timestamp = i / 30.0;
    const slam::FrameTrack track = system.track(system.prepare(again, system.initialised()));
    ASSERT_EQ(track.state, slam::TrackState::kNotInitialised) << i;
  }
}

TEST(Start, ATurningCameraWaitsUntilItMoves) {
  const auto sequence = scene("rotation-start", 30.0);
  const std::vector<engine::TimedPose> truth =
      engine::read_groundtruth(sequence->path() / "groundtruth.txt");
  slam::System system(options_for(false), sequence->camera(), slam::make_no_segmenter());
  const std::vector<slam::FrameTrack> tracks = track_all(*sequence, system);
  std::size_t first = 0;
  while (first < tracks.size() && tracks[first].state != slam::TrackState::kTracked) ++first;
  ASSERT_LT(first, tracks.size());
  const auto moved = [&](std::size_t from, std::size_t to) {
    return (truth[to].world_from_cam.translation() - truth[from].world_from_cam.translation())
        .norm();
  };
  // A hundredth of the room's depth of about 3 m is 0.6 degrees.
  const auto reference = static_cast<std::size_t>((*system.map().keyframes.begin()).frame_index);
  EXPECT_GT(moved(reference, first), 0.03);
  // And the start is right: the path from there on has the true shape.
  const std::size_t last = tracks.size() - 1;
  const std::size_t middle = (first + last) / 2;
  const auto found = [&](std::size_t from, std::size_t to) {
    return (tracks[to].cam_from_world->inverse().translation() -
            tracks[from].cam_from_world->inverse().translation())
        .norm();
  };
  EXPECT_NEAR(found(first, middle) / found(middle, last),
              moved(first, middle) / moved(middle, last),
              0.05 * moved(first, middle) / moved(middle, last));
}

}  // namespace
}  // namespace planecast
