#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <opencv2/imgcodecs.hpp>

#include "engine/evaluate/image_compare.h"
#include "render/gltf/import.h"
#include "render/renderer.h"

namespace planecast {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = PLANECAST_SOURCE_DIR;

/// Across processors a channel may differ by 2 on one pixel in a thousand (different vector units);
/// on one machine the picture is the same to the byte.
constexpr int kMaxChannelDifference = 2;
constexpr double kMaxShareBeyond = 0.001;

render::Camera camera_over_the_plane() {
  render::Camera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 300.0F;
  camera.cx = 159.5F;
  camera.cy = 119.5F;
  // The world is y-up; the camera convention is y-down, z-forward.
  const glm::mat4 flip = glm::scale(glm::mat4(1.0F), glm::vec3(1, -1, -1));
  camera.camera_from_world = flip * glm::lookAt(glm::vec3(0.35F, 0.45F, 0.65F),
                                                glm::vec3(0, 0.13F, 0), glm::vec3(0, 1, 0));
  return camera;
}

/// The robot in mid-wave on a square of one metre, over a grey frame.
cv::Mat draw_robot(bool only_opengl) {
  const render::ImportResult imported =
      render::import_gltf((kRoot / "assets/models/robot.glb").string());
  if (!imported.model) return {};
  render::LayerScene scene;
  render::Instance robot;
  robot.model = imported.model;
  robot.animation = 0;
  robot.animation_time_s = 0.5F;
  scene.instances.push_back(robot);
  render::PlanePatch floor;
  floor.normal = {0, 1, 0};
  floor.outer = {{-0.5F, 0, 0.5F}, {0.5F, 0, 0.5F}, {0.5F, 0, -0.5F}, {-0.5F, 0, -0.5F}};
  scene.catchers.push_back(floor);
  render::Sun sun;
  sun.direction_to_light = glm::normalize(glm::vec3(-0.5F, 1.0F, 0.4F));
  scene.light = render::Light::uniform(glm::vec3(0.5F), sun);
  render::RendererOptions options;
  options.shader_dir = (kRoot / "assets/shaders").string();
  options.only_opengl = only_opengl;
  render::Renderer renderer(options);
  const render::Layer layer = renderer.draw_layer(scene, camera_over_the_plane());

  cv::Mat frame(layer.rgba.height, layer.rgba.width, CV_8UC3);
  for (int y = 0; y < frame.rows; ++y) {
    for (int x = 0; x < frame.cols; ++x) {
      const std::uint8_t* rgba =
          &layer.rgba
               .pixels[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.cols) +
                            static_cast<std::size_t>(x))];
      const int behind = 160 * (255 - rgba[3]) / 255;
      for (int c = 0; c < 3; ++c) {
        frame.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<std::uint8_t>(rgba[2 - c] + behind);
      }
    }
  }
  return frame;
}

void expect_golden(const cv::Mat& actual, const char* name) {
  ASSERT_FALSE(actual.empty());
  const fs::path golden = kRoot / "test/golden/expected" / name;
  if (std::getenv("PLANECAST_UPDATE_GOLDEN") != nullptr) {
    ASSERT_TRUE(cv::imwrite(golden.string(), actual));
  }
  const cv::Mat expected = cv::imread(golden.string());
  const engine::ImageDifference difference =
      engine::compare_images(expected, actual, kMaxChannelDifference);
  ASSERT_TRUE(difference.comparable) << golden << " is missing or of another size";
  EXPECT_LE(difference.share_beyond, kMaxShareBeyond);
  EXPECT_GT(difference.ssim, 0.999);
}

TEST(GoldenFrame, RobotOnAPlane) { expect_golden(draw_robot(true), "robot_on_a_plane.png"); }

TEST(GoldenFrame, RobotOnAPlaneByTheProcessor) {
  expect_golden(draw_robot(false), "robot_on_a_plane_by_processor.png");
}

}  // namespace
}  // namespace planecast
