#include "engine/scene/write_scene_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "engine/assets.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {
namespace {

constexpr const char* kEverything = R"(
light:
  sun: {direction: [0.2, 0.9, -0.1], color: [1.0, 0.9, 0.8], intensity: 1.7}
  sky: {color: [0.4, 0.5, 0.6], intensity: 0.3}
shadows: false
occlusion: both
objects:
  - model: a.glb
    place: {frame: 12, pixel: [311.25, 87.5]}
    size: 0.31
    yaw: -12.5
    animation: Walk
  - model: a.glb
    place: {plane: largest-vertical, at: [0.25, 0.75]}
    face: keep
    animation: 1
  - model: a.glb
    place: {position: [1, -2, 3.5], normal: [0, 1, 0]}
scale: {edge: {frame: 3, from: [1, 2], to: [30, 40.5], length: 0.42}}
)";

TEST(WriteScene, ReadingBackGivesTheSameScene) {
  const TestFolder folder;
  write_file(folder / "a.glb", "not read here");
  write_file(folder / "all.yaml", kEverything);
  const SceneFile scene = read_scene_file(folder / "all.yaml");
  write_scene_file(scene, folder / "again.yaml");
  const SceneFile again = read_scene_file(folder / "again.yaml");

  ASSERT_TRUE(again.light);
  EXPECT_LT((again.light->sun_radiance - scene.light->sun_radiance).norm(), 1e-15);
  EXPECT_LT((again.light->sky_radiance - scene.light->sky_radiance).norm(), 1e-15);
  EXPECT_LT((again.light->sun_direction - scene.light->sun_direction).norm(), 1e-15);
  EXPECT_FALSE(again.shadows);
  EXPECT_EQ(again.occlusion, Occlusion::kBoth);
  ASSERT_EQ(again.objects.size(), 3U);
  const auto& pixel = std::get<PixelPlace>(again.objects[0].place);
  EXPECT_EQ(pixel.frame, 12);
  EXPECT_EQ(pixel.pixel, Eigen::Vector2d(311.25, 87.5));
  EXPECT_EQ(again.objects[0].size, 0.31);
  EXPECT_EQ(again.objects[0].yaw_deg, -12.5);
  EXPECT_EQ(again.objects[0].animation, "Walk");
  EXPECT_EQ(std::get<PlanePlace>(again.objects[1].place).plane, "largest-vertical");
  EXPECT_EQ(std::get<PlanePlace>(again.objects[1].place).at, Eigen::Vector2d(0.25, 0.75));
  EXPECT_EQ(again.objects[1].face, Face::kKeep);
  EXPECT_EQ(again.objects[1].animation_index, 1);
  EXPECT_EQ(std::get<PointPlace>(again.objects[2].place).position, Eigen::Vector3d(1, -2, 3.5));
  const auto& edge = std::get<EdgeScale>(again.scale->rule);
  EXPECT_EQ(edge.length_m, 0.42);
  EXPECT_EQ(edge.to, Eigen::Vector2d(30, 40.5));
}

TEST(WriteScene, DefaultsAreNotWritten) {
  SceneFile scene;
  SceneObject object;
  object.model = "models/a.glb";
  object.place = PlanePlace{"floor", {0.5, 0.5}};
  scene.objects.push_back(object);
  const std::string yaml = scene_yaml(scene, ".");
  for (const char* absent : {"light", "shadows", "occlusion", "scale", "yaw", "face", "size"}) {
    EXPECT_EQ(yaml.find(absent), std::string::npos) << yaml;
  }
}

TEST(WriteScene, ModelsAreNamedFromTheFilesFolder) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "models");
  std::filesystem::create_directories(folder / "scenes");
  write_file(folder / "models/a.glb", "not read here");
  SceneFile scene;
  scene.objects.emplace_back();
  scene.objects[0].model = folder / "models/a.glb";
  scene.objects[0].place = PlanePlace{"3", {0.5, 0.5}};
  EXPECT_NE(scene_yaml(scene, folder / "scenes").find("model: ../models/a.glb"), std::string::npos);
  write_scene_file(scene, folder / "scenes/s.yaml");
  const SceneFile again = read_scene_file(folder / "scenes/s.yaml");
  EXPECT_TRUE(std::filesystem::equivalent(again.objects[0].model, folder / "models/a.glb"));
}

}  // namespace
}  // namespace planecast::engine
