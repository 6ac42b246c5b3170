#include "engine/pipeline/map_bin.h"

#include <gtest/gtest.h>

#include "slam/features/pyramid.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {
namespace {

/// Two keyframes that see one landmark, with pictures.
Reconstruction sample() {
  Reconstruction r;
  r.camera = test_camera();
  r.mode = "mono";
  slam::Map map;
  for (int id = 0; id < 2; ++id) {
    auto features = std::make_shared<slam::Features>();
    features->keypoints.resize(1);
    features->keypoints[0].raw = features->keypoints[0].pixel = {10.0F + id, 20.0F};
    features->descriptors.resize(1);
    features->build_grid(r.camera.width, r.camera.height);
    slam::Keyframe keyframe;
    keyframe.id = id;
    keyframe.cam_from_world.translation().x() = 1.0 / 3.0 * id;
    keyframe.features = features;
    keyframe.landmarks = {slam::kNone};
    keyframe.labels = {0};
    keyframe.parent = id - 1;
    cv::Mat grey(r.camera.height, r.camera.width, CV_8U);
    for (int y = 0; y < grey.rows; ++y) {
      for (int x = 0; x < grey.cols; ++x) {
        grey.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(x * 7 + y * 13 + id);
      }
    }
    keyframe.pyramid = std::make_shared<const slam::ImagePyramid>(slam::build_pyramid(grey));
    map.keyframes.put(keyframe);
  }
  slam::Landmark landmark;
  landmark.id = 0;
  landmark.position = {0.1, 0.2, 3.0};
  map.landmarks.put(landmark);
  map.add_observation(0, 0, 0);
  map.add_observation(0, 1, 0);
  r.map = std::make_shared<const slam::Map>(std::move(map));
  return r;
}

TEST(MapBin, HoldsAllThatIsNeededToGoOn) {
  const TestFolder folder;
  const Reconstruction written = sample();
  write_map_bin(written, folder / "map.bin");
  Reconstruction read;
  read_map_bin(folder / "map.bin", read, true);
  ASSERT_NE(read.map, nullptr);
  ASSERT_EQ(read.map->keyframes.size(), 2U);
  for (const slam::Keyframe& keyframe : read.map->keyframes) {
    const slam::Keyframe& same = written.map->keyframes.at(keyframe.id);
    EXPECT_EQ(keyframe.cam_from_world.matrix(), same.cam_from_world.matrix());
    ASSERT_NE(keyframe.pyramid, nullptr);
    ASSERT_EQ(keyframe.pyramid->levels.size(), same.pyramid->levels.size());
    for (std::size_t l = 0; l < same.pyramid->levels.size(); ++l) {
      EXPECT_EQ(cv::norm(keyframe.pyramid->levels[l], same.pyramid->levels[l], cv::NORM_INF), 0.0);
    }
  }
  write_map_bin(read, folder / "again.bin");
  EXPECT_EQ(read_file(folder / "again.bin"), read_file(folder / "map.bin"));
  Reconstruction without;
  read_map_bin(folder / "map.bin", without);
  EXPECT_EQ(without.map, nullptr);
}

TEST(MapBin, BadFilesGiveOneLine) {
  const TestFolder folder;
  write_map_bin(sample(), folder / "map.bin");
  const std::string bytes = read_file(folder / "map.bin");
  const auto error_of = [&](const std::string& content) {
    write_file(folder / "bad.bin", content);
    Reconstruction read;
    const std::string error = user_error_of([&] { read_map_bin(folder / "bad.bin", read, true); });
    EXPECT_NE(error.find("bad.bin"), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  };
  EXPECT_NE(error_of("").find("not a map"), std::string::npos);
  EXPECT_NE(error_of(std::string(64, 'x')).find("not a map"), std::string::npos);
  for (const std::size_t length :
       {std::size_t{9}, std::size_t{20}, std::size_t{40}, bytes.size() - 1}) {
    EXPECT_NE(error_of(bytes.substr(0, length)).find("truncated"), std::string::npos);
  }
  EXPECT_NE(error_of(bytes + "x").find("damaged"), std::string::npos);
  std::string older = bytes;
  older[8] = 1;
  EXPECT_NE(error_of(older).find("version 1"), std::string::npos);
  for (std::size_t i = 28; i < bytes.size(); i += bytes.size() / 50) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(~damaged[i]);
    EXPECT_NE(error_of(damaged).find("damaged"), std::string::npos);
  }
}

}  // namespace
}  // namespace planecast::engine
