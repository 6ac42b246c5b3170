#include "engine/scene/scene_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

class SceneFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("planecast_scene_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_ / "scenes");
    fs::create_directories(folder_ / "models");
    std::ofstream(folder_ / "models" / "a.glb") << "x";
  }
  void TearDown() override { fs::remove_all(folder_); }

  SceneFile read(const std::string& text) {
    path_ = folder_ / "scenes" / "s.yaml";
    std::ofstream(path_) << text;
    return read_scene_file(path_);
  }
  /// The message without the folder's name.
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const UserError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.rfind(path_.string(), 0), 0U) << message;
      return message.substr(path_.parent_path().string().size() + 1);
    }
    return "no error";
  }
  static std::string object(const std::string& more) {
    return "objects:\n  - model: ../models/a.glb\n" + more;
  }

  fs::path folder_;
  fs::path path_;
};

const char kTap[] = "    place: {frame: 3, pixel: [10, 20.5]}\n";

TEST_F(SceneFileTest, ReadsEveryKey) {
  const SceneFile scene = read(
      "light: {sun: {direction: [0, 2, 0], intensity: 1.5, color: [1, 0.5, 0.25]}, sky: 0.7}\n"
      "shadows: false\nocclusion: both\n"
      "objects:\n"
      "  - model: ../models/a.glb\n    place: {frame: 120, pixel: [320, 300]}\n    size: 0.3\n"
      "    yaw: 30\n    face: keep\n    animation: Walk\n"
      "  - {model: ../models/a.glb, place: {plane: largest-vertical, at: [0.25, 0.75]}, animation: "
      "2}\n"
      "  - {model: ../models/a.glb, place: {plane: 7}}\n"
      "  - {model: ../models/a.glb, place: {position: [1, 2, 3], normal: [0, -2, 0]}}\n"
      "scale: {edge: {frame: 4, from: [1, 2], to: [3, 4], length: 0.21}}\n");
  ASSERT_TRUE(scene.light.has_value());
  EXPECT_EQ(scene.light->sun_direction, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(scene.light->sun_radiance, Eigen::Vector3d(1.5, 0.75, 0.375));
  EXPECT_EQ(scene.light->sky_radiance, Eigen::Vector3d::Constant(0.7));
  EXPECT_FALSE(scene.shadows);
  EXPECT_EQ(scene.occlusion, Occlusion::kBoth);
  ASSERT_EQ(scene.objects.size(), 4U);
  const SceneObject& first = scene.objects[0];
  EXPECT_TRUE(fs::equivalent(first.model, folder_ / "models" / "a.glb"));
  EXPECT_EQ(std::get<PixelPlace>(first.place).frame, 120);
  EXPECT_EQ(std::get<PixelPlace>(first.place).pixel, Eigen::Vector2d(320, 300));
  EXPECT_EQ(first.size, 0.3);
  EXPECT_EQ(first.yaw_deg, 30.0);
  EXPECT_EQ(first.face, Face::kKeep);
  EXPECT_EQ(first.animation, "Walk");
  EXPECT_EQ(std::get<PlanePlace>(scene.objects[1].place).plane, "largest-vertical");
  EXPECT_EQ(std::get<PlanePlace>(scene.objects[1].place).at, Eigen::Vector2d(0.25, 0.75));
  EXPECT_EQ(scene.objects[1].animation_index, 2);
  EXPECT_EQ(std::get<PlanePlace>(scene.objects[2].place).plane, "7");
  EXPECT_EQ(std::get<PointPlace>(scene.objects[3].place).normal, Eigen::Vector3d(0, -1, 0));
  ASSERT_TRUE(scene.scale.has_value());
  EXPECT_EQ(std::get<EdgeScale>(scene.scale->rule).length_m, 0.21);
}

TEST_F(SceneFileTest, ReadsTheKeysOfPlacesPostersAndLook) {
  std::ofstream(folder_ / "models" / "p.jpg") << "x";
  const SceneFile scene = read(
      "ease: 4\nkeep_apart: false\n"
      "look: {grain: off, blur: off, exposure: off, lens: off, clean_edges: off}\n"
      "objects:\n"
      "  - {name: base, model: ../models/a.glb, size: {metres: 0.2},\n"
      "     place: {marker: {dictionary: 5x5_100, id: 42}, offset: [0, 0, 0.1]}}\n"
      "  - {model: ../models/a.glb, place: {on: base}, size: {relative: 0.1}, loop: false, start: "
      "2}\n"
      "  - {poster: {image: ../models/p.jpg, width: 0.6}, place: {plane: largest-vertical}}\n"
      "  - model: ../models/a.glb\n    place: {plane: 1}\n    yaw: 10\n"
      "    instances: [{offset: [0.1, 0, 0]}, {offset: [0.2, 0, 0], yaw: 20, size: 0.5, start: "
      "1}]\n"
      "scale: {marker: {id: 7, size: 0.08}}\n");
  EXPECT_EQ(scene.ease_frames, 4);
  EXPECT_FALSE(scene.keep_apart);
  EXPECT_FALSE(scene.look.grain || scene.look.blur || scene.look.exposure || scene.look.lens ||
               scene.look.clean_edges);
  ASSERT_EQ(scene.objects.size(), 5U);
  const SceneObject& base = scene.objects[0];
  EXPECT_EQ(std::get<MarkerPlace>(base.place).marker, (MarkerId{"5x5_100", 42}));
  EXPECT_EQ(base.offset, Eigen::Vector3d(0, 0, 0.1));
  EXPECT_EQ(base.unit, LengthUnit::kMetres);
  EXPECT_EQ(std::get<ObjectPlace>(scene.objects[1].place).object, "base");
  EXPECT_EQ(scene.objects[1].unit, LengthUnit::kRelative);
  EXPECT_FALSE(scene.objects[1].loop);
  EXPECT_EQ(scene.objects[1].start_s, 2.0);
  ASSERT_TRUE(scene.objects[2].poster.has_value());
  EXPECT_FALSE(scene.objects[2].poster->video);
  EXPECT_EQ(scene.objects[2].size, 0.6);
  EXPECT_EQ(scene.objects[4].offset, Eigen::Vector3d(0.2, 0, 0));
  EXPECT_EQ(scene.objects[4].yaw_deg, 30.0);
  EXPECT_EQ(scene.objects[4].size, 0.5);
  EXPECT_EQ(scene.objects[4].start_s, 1.0);
  EXPECT_EQ(markers_of(scene), (std::vector<MarkerId>{{"4x4_50", 7}, {"5x5_100", 42}}));
}

TEST_F(SceneFileTest, ReadsEveryScale) {
  const auto scale = [this](const std::string& text) {
    return read(object(kTap) + "scale: " + text + "\n").scale->rule;
  };
  EXPECT_EQ(std::get<PlaneDistanceScale>(scale("{plane_distance: 1.2, frame: 3}")).frame, 3);
  EXPECT_EQ(std::get<CameraHeightScale>(scale("{camera_height: 1.6}")).height_m, 1.6);
  const auto height =
      std::get<HeightScale>(scale("{object: {frame: 4, foot: [1, 2], top: [3, 4], height: 0.25}}"));
  EXPECT_EQ(height.foot, Eigen::Vector2d(1, 2));
  EXPECT_EQ(height.top, Eigen::Vector2d(3, 4));
  EXPECT_EQ(height.height_m, 0.25);
  EXPECT_EQ(std::get<MarkerScale>(scale("{marker: {id: 3, size: 0.1}}")).size_m, 0.1);
}

TEST_F(SceneFileTest, DefaultsAreThoseOfTheManual) {
  const SceneFile scene = read(object(kTap));
  EXPECT_FALSE(scene.light.has_value());
  EXPECT_TRUE(scene.shadows);
  EXPECT_EQ(scene.occlusion, Occlusion::kPlanes);
  EXPECT_FALSE(scene.scale.has_value());
  EXPECT_EQ(scene.objects[0].face, Face::kCamera);
  EXPECT_FALSE(scene.objects[0].size.has_value());
}

TEST_F(SceneFileTest, UnknownKeysAreNamedWithTheirLine) {
  EXPECT_EQ(error_of(object(kTap) + "    colour: red\n"), "s.yaml:4: unknown key 'colour'");
  EXPECT_EQ(error_of(object(kTap) + "shadow: true\n"), "s.yaml:4: unknown key 'shadow'");
  EXPECT_EQ(error_of(object("    place: {frame: 3, pixel: [1, 2], z: 1}\n")),
            "s.yaml:3: unknown key 'z'");
}

TEST_F(SceneFileTest, WrongValuesAreNamedWithTheirLine) {
  EXPECT_EQ(error_of(object(kTap) + "    size: big\n"), "s.yaml:4: 'size' must be a number");
  EXPECT_EQ(error_of(object(kTap) + "    size: -1\n"), "s.yaml:4: 'size' must be positive");
  EXPECT_EQ(error_of(object(kTap) + "    size: .nan\n"), "s.yaml:4: 'size' must be a number");
  EXPECT_EQ(error_of(object(kTap) + "    face: left\n"), "s.yaml:4: 'face' must be camera or keep");
  EXPECT_EQ(error_of(object(kTap) + "shadows: maybe\n"),
            "s.yaml:4: 'shadows' must be true or false");
  EXPECT_EQ(error_of(object(kTap) + "occlusion: some\n"),
            "s.yaml:4: 'occlusion' must be none, planes, depth or both");
  EXPECT_EQ(error_of(object("    place: {frame: 3, pixel: [1]}\n")),
            "s.yaml:3: 'pixel' must be a list of 2 numbers");
  EXPECT_EQ(
      error_of(object("    place: {plane: ceiling}\n")),
      "s.yaml:3: 'plane' must be an id, largest-horizontal, largest-vertical, floor or nearest");
  EXPECT_EQ(error_of(object("    place: {plane: 1, at: [0.5, 1.5]}\n")),
            "s.yaml:3: 'at' is a fraction: both numbers must lie between 0 and 1");
}

TEST_F(SceneFileTest, MissingPartsAreNamed) {
  EXPECT_EQ(error_of("objects:\n  - model: nowhere.glb\n" + std::string(kTap)),
            "s.yaml:2: model 'nowhere.glb' not found");
  EXPECT_EQ(error_of("objects:\n  - size: 2\n" + std::string(kTap)),
            "s.yaml:2: object without 'model' or 'poster'");
  EXPECT_EQ(error_of("shadows: true\n"),
            "s.yaml:1: 'objects' must be a list of at least one object");
  EXPECT_EQ(error_of(object("    size: 1\n")), "s.yaml:2: object without 'place'");
  EXPECT_EQ(error_of(object("    place: {frame: 3}\n")),
            "s.yaml:3: 'place' needs both 'frame' and 'pixel'");
}

TEST_F(SceneFileTest, WrongReferencesAreNamed) {
  EXPECT_EQ(error_of(object("    place: {on: base}\n")),
            "s.yaml:2: no object before this one has the name 'base'");
  EXPECT_EQ(error_of(object("    place: {marker: {dictionary: 9x9, id: 1}}\n"))
                .rfind("s.yaml:3: 'dictionary' must be one of 4x4_50, ", 0),
            0U);
  EXPECT_EQ(error_of(object("    place: {marker: {id: 50}}\n")),
            "s.yaml:3: 'id' must lie between 0 and 49");
  EXPECT_EQ(error_of("objects:\n  - poster: {image: no.png}\n" + std::string(kTap)),
            "s.yaml:2: image 'no.png' not found");
  EXPECT_EQ(error_of("objects:\n  - poster: {width: 2}\n" + std::string(kTap)),
            "s.yaml:2: 'poster' needs either 'image' or 'video'");
  EXPECT_EQ(error_of(object(kTap) + "    size: {feet: 2}\n"), "s.yaml:4: unknown key 'feet'");
  EXPECT_EQ(error_of(object(kTap) + "look: {grian: off}\n"), "s.yaml:4: unknown key 'grian'");
}

TEST_F(SceneFileTest, BrokenYamlIsOneLine) {
  EXPECT_EQ(error_of("objects: [\n").rfind("s.yaml:", 0), 0U);
  EXPECT_EQ(error_of("- 1\n- 2\n"), "s.yaml:1: a scene must be a mapping of keys to values");
  EXPECT_THROW(read_scene_file(folder_ / "none.yaml"), UserError);
}

}  // namespace
}  // namespace planecast::engine
