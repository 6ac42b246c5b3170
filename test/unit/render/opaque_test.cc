#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/renderer.h"

namespace planecast::render {
namespace {

Renderer make_renderer(ContextKind kind = ContextKind::kOsMesa) {
  RendererOptions options;
  options.context = kind;
  options.shader_dir = std::string(PLANECAST_SOURCE_DIR) + "/assets/shaders";
  return Renderer(options);
}

/// Parallelogram with corner `at` and sides `a`, `b`; normal a x b.
SurfaceMesh quad(const glm::vec3& at, const glm::vec3& a, const glm::vec3& b, int label) {
  SurfaceMesh mesh;
  mesh.positions = {at, at + a, at + a + b, at + b};
  mesh.normals.assign(4, glm::normalize(glm::cross(a, b)));
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.label = label;
  return mesh;
}

/// A square facing the camera, whose projection is centred at pixel (u, v).
SurfaceMesh marker(const Camera& camera, float u, float v, float z, float side_px, int label) {
  const float s = side_px * z / std::abs(camera.fx);
  const glm::vec3 center((u - camera.cx) * z / camera.fx, (v - camera.cy) * z / camera.fy, z);
  return quad(center + glm::vec3(-0.5F * s, 0.5F * s, 0.0F), {s, 0, 0}, {0, -s, 0}, label);
}

glm::vec2 centroid(const ImageU8& rgb, int u, int v, int radius) {
  double sum = 0, x = 0, y = 0;
  for (int row = v - radius; row <= v + radius; ++row) {
    for (int column = u - radius; column <= u + radius; ++column) {
      const double w = rgb.pixels[static_cast<std::size_t>((row * rgb.width + column) * 3)];
      sum += w;
      x += w * column;
      y += w * row;
    }
  }
  return sum > 0 ? glm::vec2(x / sum, y / sum) : glm::vec2(-1.0F);
}

Sun no_sun() {
  Sun sun;
  sun.radiance = glm::vec3(0.0F);
  return sun;
}

TEST(Opaque, MarkersLandOnTheirPixels) {
  Renderer renderer = make_renderer();
  for (const float fy : {525.0F, -525.0F}) {
    Camera camera;
    camera.fy = fy;
    camera.cx = 317.3F;
    camera.cy = 242.8F;
    OpaqueScene scene;
    scene.light = Light::uniform(glm::vec3(0.2F), no_sun());
    const std::vector<glm::vec2> at = {{100, 100}, {320.25F, 240}, {500, 80.5F}, {40.75F, 440.25F}};
    for (std::size_t i = 0; i < at.size(); ++i) {
      scene.surfaces.push_back(marker(camera, at[i].x, at[i].y, 1.0F + 0.7F * static_cast<float>(i),
                                      12.0F, static_cast<int>(i) + 1));
    }
    const OpaqueImages images = renderer.draw_opaque(scene, camera);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const int u = static_cast<int>(std::lround(at[i].x));
      const int v = static_cast<int>(std::lround(at[i].y));
      const glm::vec2 found = centroid(images.rgb, u, v, 12);
      EXPECT_NEAR(found.x, at[i].x, 0.05F) << i;
      EXPECT_NEAR(found.y, at[i].y, 0.05F) << i;
      EXPECT_EQ(images.labels.pixels[static_cast<std::size_t>(v * camera.width + u)], i + 1);
    }
  }
}

TEST(Opaque, DepthOfATiltedPlaneIsExact) {
  Renderer renderer = make_renderer();
  Camera camera;
  OpaqueScene scene;
  scene.light = Light::uniform(glm::vec3(0.2F), no_sun());
  const glm::vec3 a = glm::normalize(glm::vec3(1.0F, 0.1F, 0.4F)) * 40.0F;
  const glm::vec3 b = glm::normalize(glm::vec3(0.0F, -1.0F, 0.7F)) * 40.0F;
  const glm::vec3 through(0.1F, 0.2F, 3.0F);
  scene.surfaces.push_back(quad(through - 0.5F * (a + b), a, b, 7));
  const OpaqueImages images = renderer.draw_opaque(scene, camera);
  const glm::dvec3 n = glm::normalize(glm::cross(glm::dvec3(a), glm::dvec3(b)));
  double worst = 0;
  int seen = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const float z = images.depth.pixels[static_cast<std::size_t>(v * camera.width + u)];
      if (z == 0.0F) continue;
      const glm::dvec3 ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
      const double truth = glm::dot(n, glm::dvec3(through)) / glm::dot(n, ray);
      worst = std::max(worst, std::abs(z - truth) / truth);
      ++seen;
    }
  }
  EXPECT_GT(seen, 200000);
  EXPECT_LT(worst, 1e-4);
  RecordProperty("worst_relative_error", std::to_string(worst));
  std::printf("worst %g\n", worst);
}

}  // namespace
}  // namespace planecast::render
