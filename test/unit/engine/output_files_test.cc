#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "engine/output/palette.h"
#include "engine/output/planes_json.h"
#include "engine/output/ply.h"
#include "engine/output/png.h"
#include "engine/output/tables.h"
#include "engine/output/trajectory.h"
#include "engine/sequence/groundtruth.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

TEST(AtomicFile, ReplacesContentAndLeavesNoTemporary) {
  const TestFolder folder;
  write_file(folder / "a.txt", "first, longer");
  write_file(folder / "a.txt", "second");
  EXPECT_EQ(read_file(folder / "a.txt"), "second");
  EXPECT_FALSE(fs::exists(temporary_path(folder / "a.txt")));
}

TEST(AtomicFile, FailuresNameTheFileOnOneLine) {
  const TestFolder folder;
  write_file(folder / "file", "x");
  fs::create_directories(folder / "folder" / "inside");
  const std::vector<std::string> errors = {
      user_error_of([&] { write_file(folder / "missing" / "a.txt", "x"); }),
      user_error_of([&] { write_file(folder / "folder", "x"); }),
      user_error_of([&] { read_file(folder / "nothing"); }),
      user_error_of([&] { read_file(folder / "folder"); }),
      user_error_of([&] { make_folder(folder / "file"); }),
      user_error_of([&] { make_folder(folder / "file" / "below"); }),
  };
  for (const std::string& error : errors) {
    EXPECT_NE(error.find(folder.path().string()), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(AtomicFile, FullDiskIsAnErrorAndKeepsTheOldFile) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TestFolder folder;
  write_file(folder / "a.txt", "old");
  fs::create_symlink("/dev/full", temporary_path(folder / "a.txt"));
  const std::string error =
      user_error_of([&] { write_file(folder / "a.txt", std::string(1 << 20, 'x')); });
  EXPECT_NE(error.find("a.txt"), std::string::npos);
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
}

TEST(Png, ReadsBackExactly) {
  const TestFolder folder;
  cv::Mat image(7, 9, CV_8UC3);
  cv::randu(image, 0, 256);
  write_png(image, folder / "a.png");
  EXPECT_EQ(cv::norm(cv::imread((folder / "a.png").string(), cv::IMREAD_UNCHANGED), image), 0.0);
  EXPECT_FALSE(user_error_of([&] { write_png(cv::Mat(), folder / "b.png"); }).empty());
}

TEST(Png, DataUriHoldsAJpeg) {
  const cv::Mat image(5, 5, CV_8UC3, cv::Scalar(10, 20, 30));
  const std::string uri = jpeg_data_uri(image);
  // Base64 of the bytes FF D8 FF that begin every JPEG.
  EXPECT_TRUE(uri.starts_with("data:image/jpeg;base64,/9j/"));
  EXPECT_EQ((uri.size() - std::string("data:image/jpeg;base64,").size()) % 4, 0U);
}

TEST(Palette, FirstPlanesDiffer) {
  std::set<Rgb> colors = {kNoPlaneColor};
  for (int id = 0; id < 100; ++id) colors.insert(plane_color(id));
  EXPECT_EQ(colors.size(), 101U);
  EXPECT_EQ(plane_color(-1), kNoPlaneColor);
}

TEST(TrajectoryText, HasTheFormatOfTheField) {
  const TimedPose pose{1311868164.363181, make_pose(Eigen::Vector3d(0.0, 0.0, M_PI / 2.0),
                                                    Eigen::Vector3d(1.0, -2.0, 0.5))};
  EXPECT_EQ(trajectory_text({pose}),
            "# timestamp tx ty tz qx qy qz qw (world from camera)\n"
            "1311868164.363181 1.000000000000 -2.000000000000 0.500000000000 0.000000000000 "
            "0.000000000000 0.707106781187 0.707106781187\n");
  EXPECT_EQ(format_timestamp(0.0), "0.000000");
  EXPECT_EQ(format_timestamp(1.0 / 30.0), "0.03333333333333333");
}

TEST(TrajectoryText, ReadsBackToTheNanometre) {
  const TestFolder folder;
  std::vector<TimedPose> poses;
  for (int i = 0; i < 20; ++i) {
    poses.push_back({i / 29.97, make_pose(Eigen::Vector3d(0.31 * i, -0.2, 0.1 * i),
                                          Eigen::Vector3d(std::sin(i), 3.0 / (i + 1), 1e-4 * i))});
  }
  write_trajectory(poses, folder / "t.txt");
  const std::vector<TimedPose> read = read_trajectory(folder / "t.txt");
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].timestamp, poses[i].timestamp);
    EXPECT_LT((read[i].world_from_cam.matrix() - poses[i].world_from_cam.matrix()).norm(), 1e-9);
  }
}

PlaneSet sample_planes() {
  PlaneSet set;
  set.metric = true;
  set.up = Eigen::Vector3d(0.1, -0.9, 0.2).normalized();
  set.up_confidence = 0.7;
  PlaneRecord plane =
      make_rectangle(3, {0.1, 1.2, 2.3}, {0.3, -1.0, 0.05}, {1.0, 0.3, 0.0}, 1.5, 0.8);
  plane.plane_class = "floor";
  plane.inliers = 321;
  plane.rms = 1.0 / 3.0;
  plane.label = 7;
  plane.first_frame = 12;
  plane.merged_from = {1, 5};
  plane.holes = {{{0.0, 1.0, 2.0}, {0.1, 1.0, 2.0}, {0.0, 1.1, 2.0}}};
  set.planes = {plane,
                make_rectangle(9, {0.0, 0.0, 1.0}, {0.0, 0.0, -1.0}, {1.0, 0.0, 0.0}, 1.0, 1.0)};
  return set;
}

TEST(PlanesJson, ReadsBackExactly) {
  const TestFolder folder;
  const PlaneSet set = sample_planes();
  write_planes_json(set, folder / "planes.json");
  const PlaneSet read = read_planes_json(folder / "planes.json");
  EXPECT_EQ(planes_json_text(read), planes_json_text(set));
  EXPECT_TRUE(read.metric);
  ASSERT_EQ(read.planes.size(), 2U);
  EXPECT_EQ(read.planes[0].normal, set.planes[0].normal);
  EXPECT_EQ(read.planes[0].origin, set.planes[0].origin);
  EXPECT_EQ(read.planes[0].polygon, set.planes[0].polygon);
  EXPECT_EQ(read.planes[0].merged_from, set.planes[0].merged_from);
}

TEST(PlanesJson, HasTheKeysOfTheFormatInOrder) {
  const auto json = nlohmann::ordered_json::parse(planes_json_text(sample_planes()));
  std::vector<std::string> keys;
  for (const auto& item : json.at("planes").at(0).items()) keys.push_back(item.key());
  const std::vector<std::string> expected = {
      "id",      "normal", "offset", "class",       "inliers",     "rms",    "area",
      "polygon", "holes",  "label",  "first_frame", "merged_from", "origin", "x_axis"};
  EXPECT_EQ(keys, expected);
  EXPECT_EQ(json.at("units"), "metres");
}

TEST(PlanesJson, ScalesNormalsToUnitAndFillsInTheFrame) {
  const TestFolder folder;
  write_file(folder / "p.json",
             R"({"planes": [{"id": 0, "normal": [0, 0, -2], "offset": 6}], "up": [0, 0, 1]})");
  const PlaneRecord plane = read_planes_json(folder / "p.json").planes.at(0);
  EXPECT_EQ(plane.normal, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(plane.offset, 3.0);
  EXPECT_NEAR(plane.normal.dot(plane.origin) + plane.offset, 0.0, 1e-12);
  EXPECT_NEAR(plane.world_from_plane().linear().determinant(), 1.0, 1e-12);
}

TEST(PlanesJson, BrokenFilesAreOneLineErrors) {
  const TestFolder folder;
  const std::vector<std::string> broken = {
      "",
      "{",
      "[]",
      R"({"up": [0,0,1]})",
      R"({"planes": 3})",
      R"({"planes": [1]})",
      R"({"planes": [{"id": 0, "normal": [0, 1], "offset": 0}]})",
      R"({"planes": [{"id": 0, "normal": [0, 0, 0], "offset": 0}]})",
      R"({"planes": [{"id": "a", "normal": [0, 0, 1], "offset": 0}]})",
      R"({"planes": [{"id": 0, "normal": [0, 0, 1], "offset": null}]})",
      R"({"planes": [{"id": 0, "normal": [0, 0, 1], "offset": 0, "polygon": [[1]]}]})",
      R"({"planes": [{"id": 0, "normal": [0, 0, 1], "offset": 0}, {"id": 0, "normal": [0, 1, 0], "offset": 0}]})",
      R"({"units": "feet", "planes": []})",
      R"({"planes": [], "up": [0, 0, 0]})",
      "\xff\xfe\x00"};
  for (const std::string& text : broken) {
    write_file(folder / "p.json", text);
    const std::string error = user_error_of([&] { read_planes_json(folder / "p.json"); });
    EXPECT_NE(error.find("p.json"), std::string::npos) << text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(Ply, ReadsBackExactlyAndRefusesTruncation) {
  const TestFolder folder;
  std::vector<MapPoint> points(5);
  for (int i = 0; i < 5; ++i) {
    auto& point = points[static_cast<std::size_t>(i)];
    point.position = Eigen::Vector3d(0.1 * i, 1.0 / 3.0, -i);
    point.color_rgb = Eigen::Vector3f(10.5F, 20.0F, 255.0F);
    point.plane = i - 1;
  }
  write_ply(points, folder / "map.ply");
  const std::vector<MapPoint> read = read_ply(folder / "map.ply");
  ASSERT_EQ(read.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(read[i].position, points[i].position);
    EXPECT_EQ(read[i].color_rgb, points[i].color_rgb);
    EXPECT_EQ(read[i].plane, points[i].plane);
  }
  const std::string bytes = read_file(folder / "map.ply");
  for (const std::size_t size : {std::size_t{0}, std::size_t{50}, bytes.size() - 1}) {
    write_file(folder / "cut.ply", bytes.substr(0, size));
    EXPECT_FALSE(user_error_of([&] { read_ply(folder / "cut.ply"); }).empty()) << size;
  }
}

TEST(FramesCsv, ReadsBackWithQuotes) {
  const TestFolder folder;
  std::vector<FrameRecord> frames(2);
  frames[0] = {5, 1.0 / 3.0, "lost", "blurred, \"dark\"\nframe", 0, std::nullopt, std::nullopt};
  frames[1] = {6, 0.5, "tracked", "", 142, std::nullopt, std::nullopt};
  write_frames_csv(frames, folder / "frames.csv");
  EXPECT_EQ(read_file(folder / "frames.csv"),
            "index,timestamp,state,reason,inliers\n"
            "5,0.3333333333333333,lost,\"blurred, \"\"dark\"\" frame\",0\n"
            "6,0.500000,tracked,,142\n");
  const std::vector<FrameRecord> read = read_frames_csv(folder / "frames.csv");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].timestamp, 1.0 / 3.0);
  EXPECT_EQ(read[0].reason, "blurred, \"dark\" frame");
  EXPECT_EQ(read[1].inliers, 142);
  write_file(folder / "bad.csv", "index,timestamp,state,reason,inliers\n1,2,tracked,\n");
  const std::string error = user_error_of([&] { read_frames_csv(folder / "bad.csv"); });
  EXPECT_NE(error.find("bad.csv:2"), std::string::npos) << error;
}

TEST(Timings, RowsOfThePaperComeFirstAndTrackingIsTheSum) {
  Reconstruction reconstruction;
  reconstruction.frame_times = {
      {{"orb", 10.0}, {"Instance Planar Segmentation", 30.0}, {"pose", 2.0}},
      {{"orb", 12.0}, {"pose", 4.0}}};
  reconstruction.mapping_times["Local BA"] = {50.0, 60.0, 100.0};
  reconstruction.mapping_times["Something else"] = {1.0};
  const std::vector<TimingRow> rows = timing_rows(reconstruction);
  ASSERT_GE(rows.size(), 14U);
  EXPECT_EQ(rows[0].name, "Tracking");
  EXPECT_EQ(rows[0].ms.count, 2);
  EXPECT_DOUBLE_EQ(rows[0].ms.mean, 14.0);
  EXPECT_EQ(rows[1].name, "Local Mapping");
  EXPECT_EQ(rows[1].ms.count, 0);
  EXPECT_DOUBLE_EQ(rows[2].ms.mean, 30.0);
  EXPECT_EQ(rows[10].name, "Local BA");
  EXPECT_DOUBLE_EQ(rows[10].ms.mean, 70.0);
  EXPECT_DOUBLE_EQ(rows[10].ms.median, 60.0);
  EXPECT_DOUBLE_EQ(rows[10].ms.p95, 96.0);  // rank 1.9 of {50, 60, 100}: 60 + 0.9 * 40
  EXPECT_EQ(rows[11].name, "Something else");
}

}  // namespace
}  // namespace planecast::engine
