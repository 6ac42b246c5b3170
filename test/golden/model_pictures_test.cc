#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "engine/evaluate/image_compare.h"
#include "render/gltf/import.h"
#include "render/renderer.h"

namespace planecast {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = PLANECAST_SOURCE_DIR;
const fs::path kExpected = kRoot / "test/golden/expected/models";
constexpr int kSide = 128;
/// Another processor, driver or compiler may differ by so much; one machine, not at all.
constexpr int kMaxChannelDifference = 2;
constexpr double kMaxShareBeyond = 0.001;

bool updating() { return std::getenv("PLANECAST_UPDATE_GOLDEN") != nullptr; }

struct Case {
  std::string file;
  int animation = -1;
  float time_s = 0.0F;

  /// Name of its picture.
  std::string name() const {
    std::string text = fs::path(file).stem().string();
    if (animation >= 0) {
      text += "_" + std::to_string(animation) + "_at_" +
              std::to_string(std::lround(1000.0F * time_s)) + "ms";
    }
    return text;
  }
};

/// Made by scripts/make_models.py and scripts/make_test_models.py.
const std::vector<Case> kOwn = {
    {"assets/models/robot.glb"},
    {"assets/models/robot.glb", 0, 0.25F},
    {"assets/models/robot.glb", 1, 0.6F},
    {"assets/models/plant.glb"},
    {"assets/models/vase.glb"},
    {"assets/models/poster.glb"},
    {"assets/models/block.glb"},
    {"test/golden/models/alpha_modes.gltf"},
    {"test/golden/models/instances.gltf"},
    {"test/golden/models/lamps.gltf"},
    {"test/golden/models/layers.gltf"},
    {"test/golden/models/maps.gltf"},
    {"test/golden/models/metal_rough.gltf"},
    {"test/golden/models/morph.gltf", 0, 0.5F},
    {"test/golden/models/morph.gltf", 0, 1.5F},
    {"test/golden/models/paths.gltf", 0, 0.4F},
    {"test/golden/models/paths.gltf", 0, 1.3F},
    {"test/golden/models/primitive_modes.gltf"},
    {"test/golden/models/skin.gltf", 0, 0.5F},
    {"test/golden/models/skin.gltf", 0, 1.25F},
    {"test/golden/models/sparse.gltf"},
    {"test/golden/models/texture_sets.gltf"},
    {"test/golden/models/unlit_and_glow.gltf"},
    {"test/golden/models/variants.gltf"},
    {"test/golden/models/vertex_colors.gltf"},
};

/// Of the Khronos samples, which are not part of this repository: their pictures' fingerprints are.
const std::vector<Case> kSamples = {
    {"AlphaBlendModeTest/AlphaBlendModeTest.glb"},
    {"AnimatedMorphCube/AnimatedMorphCube.glb", 0, 1.0F},
    {"BoxAnimated/BoxAnimated.glb", 0, 1.5F},
    {"CesiumMan/CesiumMan.glb", 0, 0.5F},
    {"Fox/Fox.glb", 1, 0.3F},
    {"MorphStressTest/MorphStressTest.gltf", 0, 0.7F},
    {"MultiUVTest/MultiUVTest.glb"},
    {"NormalTangentTest/NormalTangentTest.glb"},
    {"OrientationTest/OrientationTest.glb"},
    {"RiggedSimple/RiggedSimple.glb", 0, 1.0F},
    {"TextureCoordinateTest/TextureCoordinateTest.glb"},
    {"VertexColorTest/VertexColorTest.glb"},
};

render::RendererOptions renderer_options(bool only_opengl,
                                         render::ContextKind kind = render::ContextKind::kOsMesa) {
  render::RendererOptions options;
  options.context = kind;
  options.shader_dir = (kRoot / "assets/shaders").string();
  options.portable_floats = true;
  options.only_opengl = only_opengl;
  return options;
}

/// Seen from the front and a little above, over a grey ground that takes shadows.
render::Layer draw(render::Renderer& renderer, const fs::path& path, const Case& c) {
  const render::ImportResult imported = render::import_gltf(path.string());
  EXPECT_NE(imported.model, nullptr) << path << ": " << imported.error;
  if (imported.model == nullptr) return {};
  EXPECT_TRUE(imported.warnings.empty()) << path << ": " << imported.warnings.front();
  const render::Bounds bounds = render::model_bounds(*imported.model);
  const glm::vec3 centre = 0.5F * (bounds.min + bounds.max);
  const float radius = 0.5F * glm::length(bounds.max - bounds.min);

  render::LayerScene scene;
  render::Instance instance;
  instance.model = imported.model;
  instance.animation = c.animation;
  instance.animation_time_s = c.time_s;
  scene.instances.push_back(instance);
  render::PlanePatch ground;
  ground.normal = {0, 1, 0};
  const float y = bounds.min.y;
  const float reach = 2.0F * radius;
  ground.outer = {{centre.x - reach, y, centre.z + reach},
                  {centre.x + reach, y, centre.z + reach},
                  {centre.x + reach, y, centre.z - reach},
                  {centre.x - reach, y, centre.z - reach}};
  ground.edge_softness_m = 0.2F * reach;
  scene.catchers.push_back(ground);
  render::Sun sun;
  sun.direction_to_light = glm::normalize(glm::vec3(0.6F, 1.0F, 0.7F));
  sun.radiance = glm::vec3(0.7F);
  scene.light = render::Light::uniform(glm::vec3(0.5F), sun);
  scene.light.ambient_sh[1] = glm::vec3(0.4F);

  render::Camera camera;
  camera.width = camera.height = kSide;
  camera.fx = camera.fy = 1.4F * kSide;
  camera.cx = camera.cy = 0.5F * (kSide - 1);
  const float distance = 3.2F * radius;
  camera.near_plane = 0.02F * distance;
  camera.far_plane = 4.0F * distance;
  const glm::vec3 eye = centre + distance * glm::normalize(glm::vec3(0.35F, 0.35F, 1.0F));
  // The world is y-up; the camera convention is y-down, z-forward.
  const glm::mat4 flip = glm::scale(glm::mat4(1.0F), glm::vec3(1, -1, -1));
  camera.camera_from_world = flip * glm::lookAt(eye, centre, glm::vec3(0, 1, 0));
  return renderer.draw_layer(scene, camera);
}

cv::Mat over_grey(const render::Layer& layer) {
  cv::Mat picture(layer.rgba.height, layer.rgba.width, CV_8UC3);
  for (int i = 0; i < picture.rows * picture.cols; ++i) {
    const std::uint8_t* rgba = &layer.rgba.pixels[4 * static_cast<std::size_t>(i)];
    const int behind = 150 * (255 - rgba[3]) / 255;
    for (int c = 0; c < 3; ++c) {
      picture.at<cv::Vec3b>(i)[c] = cv::saturate_cast<std::uint8_t>(rgba[2 - c] + behind);
    }
  }
  return picture;
}

/// FNV-1a.
std::string hash_of(const render::Layer& layer) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const std::uint8_t byte : layer.rgba.pixels) hash = (hash ^ byte) * 0x100000001B3ULL;
  char text[20];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

/// The picture in 8x8 blocks, each the mean of its pixels' RGBA, as hexadecimal bytes. Unlike a
/// hash it bears what another processor may change.
std::string fingerprint_of(const render::Layer& layer) {
  constexpr int kBlocks = 8;
  const cv::Mat rgba(layer.rgba.height, layer.rgba.width, CV_8UC4,
                     const_cast<std::uint8_t*>(layer.rgba.pixels.data()));
  cv::Mat blocks;
  cv::resize(rgba, blocks, {kBlocks, kBlocks}, 0, 0, cv::INTER_AREA);
  std::string text;
  for (int i = 0; i < kBlocks * kBlocks; ++i) {
    for (int c = 0; c < 4; ++c) text += fmt::format("{:02x}", blocks.at<cv::Vec4b>(i)[c]);
  }
  return text;
}

/// The largest difference of two fingerprints' bytes; 255 where they are not of one length.
int fingerprint_difference(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return 255;
  int largest = 0;
  for (std::size_t i = 0; i + 1 < a.size(); i += 2) {
    const int difference =
        std::stoi(a.substr(i, 2), nullptr, 16) - std::stoi(b.substr(i, 2), nullptr, 16);
    largest = std::max(largest, std::abs(difference));
  }
  return largest;
}

fs::path sample_folder() {
  const char* given = std::getenv("PLANECAST_DATA");
  return (given != nullptr ? fs::path(given) : kRoot / ".." / "shared" / "data") / "gltf" / "core";
}

TEST(GoldenModels, OwnModelsLookAsCommitted) {
  render::Renderer renderer(renderer_options(true));
  for (const Case& c : kOwn) {
    SCOPED_TRACE(c.name());
    const cv::Mat actual = over_grey(draw(renderer, kRoot / c.file, c));
    const fs::path golden = kExpected / (c.name() + ".png");
    if (updating()) {
      fs::create_directories(kExpected);
      ASSERT_TRUE(cv::imwrite(golden.string(), actual));
    }
    const cv::Mat expected = cv::imread(golden.string());
    const engine::ImageDifference difference =
        engine::compare_images(expected, actual, kMaxChannelDifference);
    ASSERT_TRUE(difference.comparable) << golden << " is missing or of another size";
    EXPECT_LE(difference.share_beyond, kMaxShareBeyond);
  }
}

TEST(GoldenModels, SampleModelsHaveTheirFingerprints) {
  if (!fs::is_directory(sample_folder())) GTEST_SKIP() << "no sample models on this machine";
  const fs::path list = kExpected / "samples.txt";
  std::map<std::string, std::string> expected;
  if (!updating()) {
    std::ifstream in(list);
    for (std::string print, name; in >> print >> name;) expected[name] = print;
  }
  std::ofstream out;
  if (updating()) out.open(list);
  render::Renderer renderer(renderer_options(true));
  for (const Case& c : kSamples) {
    SCOPED_TRACE(c.name());
    const std::string print = fingerprint_of(draw(renderer, sample_folder() / c.file, c));
    if (updating()) {
      out << print << ' ' << c.name() << '\n';
    } else {
      EXPECT_LE(fingerprint_difference(print, expected[c.name()]), kMaxChannelDifference);
    }
  }
}

/// What the committed pictures cannot show: one machine gives the same bytes every time.
TEST(GoldenModels, SameBytesInASecondRunOnTwoThreadsAndOnBothContexts) {
  const std::vector<Case> cases = {
      {"assets/models/robot.glb", 0, 0.25F},     {"assets/models/vase.glb"},
      {"test/golden/models/layers.gltf"},        {"test/golden/models/alpha_modes.gltf"},
      {"test/golden/models/skin.gltf", 0, 0.5F},
  };
  const auto hashes = [&](render::ContextKind kind, bool backwards) {
    render::Renderer renderer(renderer_options(false, kind));
    std::vector<std::string> result(cases.size());
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const std::size_t i = backwards ? cases.size() - 1 - k : k;
      result[i] = hash_of(draw(renderer, kRoot / cases[i].file, cases[i]));
    }
    return result;
  };
  const auto first = hashes(render::ContextKind::kOsMesa, false);
  std::vector<std::string> one;
  std::vector<std::string> two;
  std::thread other([&] { one = hashes(render::ContextKind::kOsMesa, true); });
  two = hashes(render::ContextKind::kOsMesa, false);
  other.join();
  EXPECT_EQ(one, first);
  EXPECT_EQ(two, first);
  EXPECT_EQ(hashes(render::ContextKind::kEgl, false), first);
}

}  // namespace
}  // namespace planecast
