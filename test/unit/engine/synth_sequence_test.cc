#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "engine/sequence/groundtruth.h"
#include "engine/sequence/sequence.h"
#include "engine/sequence/synth.h"
#include "sequence_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

SynthOptions tiny(const std::string& name) {
  SynthOptions options;
  options.name = name;
  options.width = 96;
  options.height = 72;
  options.frames = 3;
  options.fps = 2.0;
  options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
  return options;
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), folder));
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct TrueEquation {
  Eigen::Vector3d normal;
  double offset;
};

std::map<int, TrueEquation> read_planes(const fs::path& file) {
  std::map<int, TrueEquation> planes;
  const auto root = nlohmann::json::parse(file_bytes(file));
  EXPECT_EQ(root["units"], "metres");
  for (const auto& plane : root["planes"]) {
    const auto& n = plane["normal"];
    planes[plane["label"].get<int>()] = {Eigen::Vector3d(n[0], n[1], n[2]), plane["offset"]};
  }
  return planes;
}

TEST(Synth, TheSameBytesTwice) {
  TestFolder folder;
  const SynthOptions options = tiny("tabletop");
  write_synthetic(options, folder.path() / "a", nullptr);
  write_synthetic(options, folder.path() / "b", nullptr);
  const std::vector<fs::path> files = files_below(folder.path() / "a");
  EXPECT_EQ(files.size(), 3u * 3u + 6u);
  ASSERT_EQ(files, files_below(folder.path() / "b"));
  for (const fs::path& file : files) {
    EXPECT_EQ(file_bytes(folder.path() / "a" / file), file_bytes(folder.path() / "b" / file))
        << file;
  }
}

TEST(Synth, AnotherSeedIsAnotherSequence) {
  TestFolder folder;
  SynthOptions options = tiny("corner");
  options.frames = 1;
  write_synthetic(options, folder.path() / "a", nullptr);
  options.seed = 2;
  write_synthetic(options, folder.path() / "b", nullptr);
  EXPECT_NE(file_bytes(folder.path() / "a/rgb/0.000000.png"),
            file_bytes(folder.path() / "b/rgb/0.000000.png"));
}

/// Every labelled pixel, taken back into the world by its depth and the true pose, lies on its
/// plane.
TEST(Synth, DepthPosesAndPlanesAgree) {
  for (const std::string& name : synthetic_scene_names()) {
    TestFolder folder;
    SynthOptions options = tiny(name);
    options.effects = false;
    write_synthetic(options, folder.path(), nullptr);
    const auto sequence = open_sequence(folder.path(), {});
    EXPECT_TRUE(sequence->warnings().empty()) << name;
    const auto poses = read_trajectory(folder.path() / "groundtruth.txt");
    const auto planes = read_planes(folder.path() / "planes.json");
    ASSERT_EQ(poses.size(), 3u);
    const slam::Camera& camera = sequence->camera();
    int labelled = 0;
    for (int i = 0; i < 3; ++i) {
      const slam::FrameInput frame = sequence->read(i);
      const slam::Pose& world_from_cam = poses[static_cast<std::size_t>(i)].world_from_cam;
      EXPECT_DOUBLE_EQ(frame.timestamp, poses[static_cast<std::size_t>(i)].timestamp);
      for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
          const int label = frame.labels.at<std::uint16_t>(y, x);
          const float z = frame.depth.at<float>(y, x);
          if (label == 0 || z == 0.0F) continue;
          ++labelled;
          ASSERT_TRUE(planes.contains(label)) << name;
          const Eigen::Vector3d point = world_from_cam * (z * camera.ray({x, y}));
          const TrueEquation& plane = planes.at(label);
          // 1 mm: depth is stored in steps of 0.2 mm, the rest is float rounding and the panes'
          // half millimetre.
          ASSERT_LT(std::abs(plane.normal.dot(point) + plane.offset), 1e-3)
              << name << " frame " << i << " pixel " << x << ", " << y << " label " << label;
          // Seen from its front.
          ASSERT_GT(plane.normal.dot(world_from_cam.translation()) + plane.offset, 0.0) << name;
        }
      }
    }
    EXPECT_GT(labelled, 96 * 72) << name;  // more than a third of all pixels
  }
}

/// Mean distance of the labelled pixels' points from their planes, metres.
double mean_plane_distance(Sequence& sequence, const fs::path& folder, bool know_the_lens) {
  const auto poses = read_trajectory(folder / "groundtruth.txt");
  const auto planes = read_planes(folder / "planes.json");
  const slam::Camera& camera = sequence.camera();
  const slam::FrameInput frame = sequence.read(0);
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const int label = frame.labels.at<std::uint16_t>(y, x);
      const float z = frame.depth.at<float>(y, x);
      if (label == 0 || z == 0.0F) continue;
      const Eigen::Vector2d pixel =
          know_the_lens ? camera.undistort(Eigen::Vector2d(x, y)) : Eigen::Vector2d(x, y);
      const Eigen::Vector3d point = poses[0].world_from_cam * (z * camera.ray(pixel));
      sum += std::abs(planes.at(label).normal.dot(point) + planes.at(label).offset);
      ++count;
    }
  }
  EXPECT_GT(count, camera.width * camera.height / 3);
  return sum / std::max(count, 1);
}

TEST(Synth, AWideLensDistortsAsItsCameraFileSays) {
  TestFolder folder;
  SynthOptions options = tiny("corner");
  options.lens = "wide";
  options.width = 320;
  options.height = 240;
  options.frames = 1;
  options.effects = false;
  write_synthetic(options, folder.path(), nullptr);
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_TRUE(sequence->camera().has_distortion());
  // Depth is that of the nearest drawn pixel: 0.38 px off on average, at a focal length of 187 px
  // and 2.5 m 5 mm on a surface seen at 45 degrees.
  const double with_lens = mean_plane_distance(*sequence, folder.path(), true);
  EXPECT_LT(with_lens, 0.005);
  EXPECT_GT(mean_plane_distance(*sequence, folder.path(), false), 5.0 * with_lens);
}

TEST(Synth, ACoveredLensSeesNothing) {
  TestFolder folder;
  SynthOptions options = tiny("tracking-loss");
  options.fps = 1.0;
  options.frames = 6;
  write_synthetic(options, folder.path(), nullptr);
  const auto sequence = open_sequence(folder.path(), {});
  EXPECT_LT(cv::mean(sequence->read(5).image)[1], 30.0);
  EXPECT_EQ(cv::countNonZero(sequence->read(5).depth), 0);
  EXPECT_GT(cv::mean(sequence->read(3).image)[1], 50.0);
}

TEST(Synth, ErrorsAreOneLine) {
  TestFolder folder;
  SynthOptions options = tiny("castle");
  EXPECT_EQ(user_error([&] {
              write_synthetic(options, folder.path(), nullptr);
            }).find("castle: no such synthetic scene (tabletop, "),
            0u);
  options.name = "tabletop";
  options.width = 3;
  EXPECT_NE(user_error([&] { write_synthetic(options, folder.path(), nullptr); }), "");
  options.width = 64;
  const auto file = folder.write("file", "x");
  EXPECT_EQ(
      user_error([&] { write_synthetic(options, file, nullptr); }).find((file / "rgb").string()),
      0u);
}

}  // namespace
}  // namespace planecast::engine
