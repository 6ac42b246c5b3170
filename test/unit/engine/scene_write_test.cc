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

constexpr const char* kNewerKeys = R"(
look: {grain: off, clean_edges: off}
keep_apart: false
ease: 3
objects:
  - name: base
    model: a.glb
    place: {marker: {dictionary: 5x5_100, id: 42}, offset: [0, 0.5, 0.1]}
    size: {metres: 0.2}
    loop: false
    start: 1.5
  - model: a.glb
    place: {on: base}
    size: {relative: 0.1}
  - poster: {image: p.png, width: 0.6}
    place: {plane: 3}
scale: {object: {frame: 3, foot: [1, 2], top: [30, 40.5], height: 0.42}}
)";

TEST(WriteScene, KeepsPostersMarkersAndSwitches) {
  const TestFolder folder;
  write_file(folder / "a.glb", "not read here");
  write_file(folder / "p.png", "not read here");
  write_file(folder / "all.yaml", kNewerKeys);
  const SceneFile scene = read_scene_file(folder / "all.yaml");
  write_scene_file(scene, folder / "again.yaml");
  const SceneFile again = read_scene_file(folder / "again.yaml");
  EXPECT_FALSE(again.look.grain || again.look.clean_edges);
  EXPECT_TRUE(again.look.blur && again.look.exposure && again.look.lens);
  EXPECT_FALSE(again.keep_apart);
  EXPECT_EQ(again.ease_frames, 3);
  ASSERT_EQ(again.objects.size(), 3U);
  const SceneObject& base = again.objects[0];
  EXPECT_EQ(base.name, "base");
  EXPECT_EQ(std::get<MarkerPlace>(base.place).marker, (MarkerId{"5x5_100", 42}));
  EXPECT_EQ(base.offset, Eigen::Vector3d(0, 0.5, 0.1));
  EXPECT_EQ(base.size, 0.2);
  EXPECT_EQ(base.unit, LengthUnit::kMetres);
  EXPECT_FALSE(base.loop);
  EXPECT_EQ(base.start_s, 1.5);
  EXPECT_EQ(std::get<ObjectPlace>(again.objects[1].place).object, "base");
  EXPECT_EQ(again.objects[1].unit, LengthUnit::kRelative);
  ASSERT_TRUE(again.objects[2].poster.has_value());
  EXPECT_EQ(again.objects[2].size, 0.6);
  EXPECT_EQ(std::get<HeightScale>(again.scale->rule).top, Eigen::Vector2d(30, 40.5));
  EXPECT_EQ(scene_yaml(again, folder.path()), scene_yaml(scene, folder.path()));
}

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
