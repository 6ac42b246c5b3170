#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/output/tables.h"
#include "engine/pipeline/reconstruction_io.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

Reconstruction sample() {
  Reconstruction r;
  r.camera = test_camera();
  r.camera.distortion = {0.1, -0.2, 1e-3, 1.0 / 3.0, 0.5};
  r.camera.guessed = true;
  r.metric = true;
  r.mode = "rgbd";
  r.segmentation = "network 1";
  r.median_depth = 1.0 / 7.0;
  r.up = Eigen::Vector3d(0.1, -1.0, 0.05).normalized();
  r.up_confidence = 0.9;
  r.warnings = {"one", "two, with a comma"};
  const char* states[] = {"not-initialised", "tracked", "lost", "localised", "tracked"};
  for (int i = 0; i < 5; ++i) {
    FrameRecord frame;
    frame.index = 100 + i;
    frame.timestamp = 1311868164.363181 + i / 30.0;
    frame.state = states[i];
    frame.reason = i == 2 ? "too few matches" : "";
    frame.inliers = 10 * i;
    if (i != 2)
      frame.world_from_cam = make_pose({0.1 * i, 0.2, -0.3}, {1.0 / 3.0, i * 1.0, -i * 0.7});
    if (i == 1 || i == 4)
      frame.causal_world_from_cam = make_pose({0.1 * i, 0.21, -0.3}, {0.3, i * 1.0, 0.0});
    r.frames.push_back(frame);
    r.frame_times.push_back({{"orb", 10.0 + i}, {"pose", 1.0 / 3.0}});
  }
  r.keyframes = {{101, r.frames[1].timestamp, *r.frames[1].world_from_cam},
                 {104, r.frames[4].timestamp, *r.frames[4].world_from_cam}};
  r.planes = {make_rectangle(2, {0.3, 1.0, 2.0}, {0.1, -1.0, 0.2}, {1.0, 0.1, 0.0}, 1.0, 2.0)};
  r.points.resize(3);
  r.points[1] = {{1.0 / 3.0, 2.0, -5.0}, {1.0F, 2.5F, 254.9F}, 2};
  r.mapping_times["Local BA"] = {50.0, 1.0 / 3.0};
  return r;
}

void expect_same_pose(const std::optional<slam::Pose>& a, const std::optional<slam::Pose>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_LT((a->matrix() - b->matrix()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ReconstructionFolder, ReadsBackWhatWasWritten) {
  const TestFolder folder;
  const Reconstruction r = sample();
  write_reconstruction(r, folder / "map");
  const Reconstruction read = read_reconstruction(folder / "map");
  EXPECT_EQ(read.camera.width, 640);
  EXPECT_EQ(read.camera.fx, r.camera.fx);
  EXPECT_EQ(read.camera.fy, r.camera.fy);
  EXPECT_EQ(read.camera.cx, r.camera.cx);
  EXPECT_EQ(read.camera.cy, r.camera.cy);
  EXPECT_EQ(read.camera.distortion, r.camera.distortion);
  EXPECT_TRUE(read.camera.guessed);
  EXPECT_TRUE(read.metric);
  EXPECT_EQ(read.mode, r.mode);
  EXPECT_EQ(read.segmentation, r.segmentation);
  EXPECT_EQ(read.median_depth, r.median_depth);
  EXPECT_EQ(read.up, r.up);
  EXPECT_EQ(read.up_confidence, r.up_confidence);
  EXPECT_EQ(read.warnings, r.warnings);
  ASSERT_EQ(read.frames.size(), r.frames.size());
  for (std::size_t i = 0; i < r.frames.size(); ++i) {
    EXPECT_EQ(read.frames[i].index, r.frames[i].index);
    EXPECT_EQ(read.frames[i].timestamp, r.frames[i].timestamp);
    EXPECT_EQ(read.frames[i].state, r.frames[i].state);
    EXPECT_EQ(read.frames[i].reason, r.frames[i].reason);
    EXPECT_EQ(read.frames[i].inliers, r.frames[i].inliers);
    expect_same_pose(read.frames[i].world_from_cam, r.frames[i].world_from_cam);
    expect_same_pose(read.frames[i].causal_world_from_cam, r.frames[i].causal_world_from_cam);
  }
  ASSERT_EQ(read.keyframes.size(), 2U);
  EXPECT_EQ(read.keyframes[1].frame_index, 104);
  expect_same_pose(read.keyframes[1].world_from_cam, r.keyframes[1].world_from_cam);
  ASSERT_EQ(read.planes.size(), 1U);
  EXPECT_EQ(read.planes[0].polygon, r.planes[0].polygon);
  EXPECT_EQ(read.planes[0].x_axis, r.planes[0].x_axis);
  ASSERT_EQ(read.points.size(), 3U);
  EXPECT_EQ(read.points[1].position, r.points[1].position);
  EXPECT_EQ(read.points[1].plane, 2);
}

/// What the report of a resumed run shows of the tracking that it did not do itself.
TEST(ReconstructionFolder, ReadsBackTheTimes) {
  const TestFolder folder;
  Reconstruction r = sample();
  r.frame_times.assign(r.frames.size(), {});
  r.frame_times[0] = {{"Tracking", 1.5}, {"with, comma", 2.25}};
  r.frame_times[1] = {{"with, comma", 4.0}};
  r.mapping_times["Local BA"] = {10.0, 20.0};
  r.plane_rms = PlaneRms{0.5, 0.25};
  write_reconstruction(r, folder / "map");
  const Reconstruction read = read_reconstruction(folder / "map");
  EXPECT_EQ(read.frame_times, r.frame_times);
  const std::vector<TimingRow> written = timing_rows(r);
  const std::vector<TimingRow> rows = timing_rows(read);
  ASSERT_EQ(rows.size(), written.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].name, written[i].name);
    EXPECT_EQ(rows[i].ms.count, written[i].ms.count);
    EXPECT_DOUBLE_EQ(rows[i].ms.p95, written[i].ms.p95);
  }
  ASSERT_TRUE(read.plane_rms.has_value());
  EXPECT_EQ(read.plane_rms->after, 0.25);
  std::filesystem::remove(folder / "map" / "times.csv");
  std::filesystem::remove(folder / "map" / "timings.json");
  EXPECT_TRUE(read_reconstruction(folder / "map").timings.empty());
}

TEST(ReconstructionFolder, HoldsTheFilesOfTheFormatAndNothingElse) {
  const TestFolder folder;
  write_reconstruction(sample(), folder / "map");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "map")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  const std::vector<std::string> expected = {"camera.chan",
                                             "frames.csv",
                                             "keyframes.txt",
                                             "map.bin",
                                             "map.ply",
                                             "map_changes.csv",
                                             "planes.json",
                                             "scene.glb",
                                             "summary.json",
                                             "times.csv",
                                             "timings.json",
                                             "trajectory.txt",
                                             "trajectory_causal.txt"};
  EXPECT_EQ(names, expected);
}

TEST(ReconstructionFolder, WritingTwiceGivesTheSameBytes) {
  const TestFolder folder;
  write_reconstruction(sample(), folder / "a");
  write_reconstruction(read_reconstruction(folder / "a"), folder / "b");
  for (const auto& entry : fs::directory_iterator(folder / "a")) {
    const fs::path name = entry.path().filename();
    // Rotations pass through quaternions of 12 decimals, which may move a last digit.
    if (name.string().starts_with("trajectory") || name == "keyframes.txt" || name == "scene.glb")
      continue;
    // Times are of the run that took them and are not read back.
    if (name == "times.csv" || name == "timings.json") continue;
    EXPECT_TRUE(read_file(entry.path()) == read_file(folder / "b" / name)) << name;
  }
}

TEST(ReconstructionFolder, SummaryCounts) {
  const TestFolder folder;
  write_reconstruction(sample(), folder / "map");
  const auto json = nlohmann::json::parse(read_file(folder.path() / "map" / "summary.json"));
  EXPECT_EQ(json.at("frames").at("count"), 5);
  EXPECT_EQ(json.at("frames").at("tracked"), 2);
  EXPECT_EQ(json.at("frames").at("localised"), 4);
  EXPECT_EQ(json.at("frames").at("until_initialised"), 1);
  EXPECT_EQ(json.at("frames").at("first_tracked"), 101);
  EXPECT_EQ(json.at("points_on_planes"), 1);
  EXPECT_EQ(json.at("units"), "metres");
}

TEST(ReconstructionFolder, NeverInitialisedRunSurvives) {
  const TestFolder folder;
  Reconstruction r;
  r.camera = test_camera();
  r.frames.resize(2);
  r.frames[1].timestamp = 0.5;
  write_reconstruction(r, folder / "map");
  const Reconstruction read = read_reconstruction(folder / "map");
  EXPECT_EQ(read.frames.size(), 2U);
  EXPECT_FALSE(read.frames[0].world_from_cam);
  EXPECT_TRUE(read.planes.empty());
}

TEST(ReconstructionFolder, AnEditedPlaneCounts) {
  const TestFolder folder;
  write_reconstruction(sample(), folder / "map");
  const fs::path path = folder.path() / "map" / "planes.json";
  auto json = nlohmann::ordered_json::parse(read_file(path));
  json["planes"][0]["class"] = "wall";
  write_file(path, json.dump());
  EXPECT_EQ(read_reconstruction(folder / "map").planes.at(0).plane_class, "wall");
}

TEST(ReconstructionFolder, EveryMissingOrCutFileIsAOneLineError) {
  const TestFolder folder;
  write_reconstruction(sample(), folder / "map");
  const fs::path map = folder / "map";
  EXPECT_NE(user_error_of([&] { read_reconstruction(folder / "none"); }).find("none"),
            std::string::npos);
  EXPECT_NE(user_error_of([&] { read_reconstruction(folder.path()); }).find("map.bin"),
            std::string::npos);
  for (const char* name : {"map.bin", "frames.csv", "trajectory.txt", "trajectory_causal.txt",
                           "keyframes.txt", "planes.json", "map.ply"}) {
    const std::string bytes = read_file(map / name);
    fs::remove(map / name);
    std::string error = user_error_of([&] { read_reconstruction(map); });
    EXPECT_NE(error.find(name), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    write_file(map / name, bytes.substr(0, bytes.size() - 3));
    error = user_error_of([&] { read_reconstruction(map); });
    // A text file without its last digits may still be one; binary and JSON are not.
    const std::string extension = fs::path(name).extension();
    if (extension == ".txt") {
      EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    } else {
      EXPECT_NE(error.find(name), std::string::npos) << name << ": " << error;
    }
    write_file(map / name, bytes);
  }
  EXPECT_EQ(user_error_of([&] { read_reconstruction(map); }), "");
}

TEST(ReconstructionFolder, NoByteOfTheMapCanCrashTheReader) {
  const TestFolder folder;
  write_reconstruction(sample(), folder / "map");
  const fs::path path = folder.path() / "map" / "map.bin";
  const std::string bytes = read_file(path);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string broken = bytes;
    broken[i] = static_cast<char>(~broken[i]);
    write_file(path, broken);
    user_error_of([&] { read_reconstruction(folder / "map"); });
  }
}

TEST(ReconstructionFolder, PoseOfAnUnknownFrameIsAnError) {
  const TestFolder folder;
  write_reconstruction(sample(), folder / "map");
  write_file(folder.path() / "map" / "trajectory.txt", "3.5 0 0 0 0 0 0 1\n");
  const std::string error = user_error_of([&] { read_reconstruction(folder / "map"); });
  EXPECT_NE(error.find("trajectory.txt"), std::string::npos) << error;
}

TEST(PlaneRecord, OwnFrameHasTheNormalAsZ) {
  const PlaneRecord plane =
      make_rectangle(0, {1.0, 2.0, 3.0}, {0.2, -1.0, 0.1}, {1.0, 0.2, 0.0}, 1.0, 1.0);
  const slam::Pose pose = plane.world_from_plane();
  EXPECT_LT((pose.linear() * Eigen::Vector3d::UnitZ() - plane.normal).norm(), 1e-12);
  EXPECT_LT((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
  EXPECT_EQ(pose.translation(), plane.origin);
}

}  // namespace
}  // namespace planecast::engine
