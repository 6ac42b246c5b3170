#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/renderer.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

using test::at;
using test::no_sun;
using test::quad;

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
      const double w = at(rgb, column, row);
      sum += w;
      x += w * column;
      y += w * row;
    }
  }
  return sum > 0 ? glm::vec2(x / sum, y / sum) : glm::vec2(-1.0F);
}

TEST(Opaque, MarkersLandOnTheirPixels) {
  Renderer renderer(test::renderer_options());
  for (const float fy : {525.0F, -525.0F}) {
    Camera camera;
    camera.fy = fy;
    camera.cx = 317.3F;
    camera.cy = 242.8F;
    OpaqueScene scene;
    scene.light = Light::uniform(glm::vec3(0.2F), no_sun());
    const std::vector<glm::vec2> places = {
        {100, 100}, {320.25F, 240}, {500, 80.5F}, {40.75F, 440.25F}};
    for (std::size_t i = 0; i < places.size(); ++i) {
      scene.surfaces.push_back(marker(camera, places[i].x, places[i].y,
                                      1.0F + 0.7F * static_cast<float>(i), 12.0F,
                                      static_cast<int>(i) + 1));
    }
    const OpaqueImages images = renderer.draw_opaque(scene, camera);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const int u = static_cast<int>(std::lround(places[i].x));
      const int v = static_cast<int>(std::lround(places[i].y));
      const glm::vec2 found = centroid(images.rgb, u, v, 12);
      EXPECT_NEAR(found.x, places[i].x, 0.05F) << i;
      EXPECT_NEAR(found.y, places[i].y, 0.05F) << i;
      EXPECT_EQ(at(images.labels, u, v), i + 1);
    }
  }
}

TEST(Opaque, DepthOfATiltedPlaneIsExact) {
  Renderer renderer(test::renderer_options());
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
      const float z = at(images.depth, u, v);
      if (z == 0.0F) continue;
      const glm::dvec3 ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
      const double truth = glm::dot(n, glm::dvec3(through)) / glm::dot(n, ray);
      worst = std::max(worst, std::abs(z - truth) / truth);
      ++seen;
    }
  }
  EXPECT_GT(seen, 200000);
  EXPECT_LT(worst, 1e-4);
}

/// A ball as a surface, white.
SurfaceMesh ball(const glm::vec3& center, float radius) {
  const Primitive sphere = test::sphere_primitive(radius);
  SurfaceMesh mesh;
  for (const ShapeVertex& vertex : sphere.shape) {
    mesh.positions.push_back(center + vertex.position);
    mesh.normals.push_back(vertex.normal);
  }
  mesh.indices = sphere.indices;
  return mesh;
}

TEST(Opaque, LambertBallUnderUniformLightShowsAlbedoTimesRadiance) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  OpaqueScene scene;
  scene.light = Light::uniform(glm::vec3(0.8F, 0.5F, 0.3F), no_sun());
  scene.surfaces.push_back(ball({0, 0, 3}, 0.8F));
  scene.surfaces[0].color_factor = glm::vec3(0.5F, 0.6F, 0.7F);
  const OpaqueImages images = renderer.draw_opaque(scene, camera);
  const glm::vec3 expected(0.5F * 0.8F, 0.6F * 0.5F, 0.7F * 0.3F);
  // One grey level for rounding and one for interpolated normals.
  for (const int offset : {-80, -40, 0, 40, 80}) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(at(images.rgb, 320 + offset, 240 + offset, c), test::encoded(expected[c]), 2.0F);
    }
  }
}

TEST(Opaque, DirectionalAmbientFollowsTheSphericalHarmonics) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  OpaqueScene scene;
  scene.light = Light::uniform(glm::vec3(0.4F), no_sun());
  scene.light.ambient_sh[1] = glm::vec3(-0.5F);  // brighter from above, y being down
  scene.surfaces.push_back(quad({-1, 1, 4}, {2, 0, 0}, {0, -2, 0}));  // faces the camera: -z
  scene.surfaces.push_back(quad({-1, 1, 2}, {0, 0, 2}, {2, 0, 0}));   // floor: faces +y or -y
  const float side = scene.surfaces[1].normals[0].y;
  const OpaqueImages images = renderer.draw_opaque(scene, camera);
  EXPECT_NEAR(at(images.rgb, 320, 240), test::encoded(0.4F), 1.0F);
  EXPECT_NEAR(at(images.rgb, 320, 420), test::encoded(0.4F - 0.5F * 0.488603F * 2.0F / 3.0F * side),
              1.5F);
}

TEST(Opaque, SunCastsShadowOnlyBehindTheBlocker) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  OpaqueScene scene;
  Sun sun;
  sun.direction_to_light = glm::vec3(0, 0, -1);
  sun.radiance = glm::vec3(0.5F);
  scene.light = Light::uniform(glm::vec3(0.1F), sun);
  scene.surfaces.push_back(quad({-2, 2, 4}, {4, 0, 0}, {0, -4, 0}, 1));
  scene.surfaces.push_back(quad({0.5F, 0.2F, 3}, {0.4F, 0, 0}, {0, -0.4F, 0}, 2));
  for (SurfaceMesh& surface : scene.surfaces) surface.normals.assign(4, glm::vec3(0, 0, -1));
  const OpaqueImages images = renderer.draw_opaque(scene, camera);
  // The shadow of the blocker is straight behind it: x in 0.5..0.9 at z = 4, seen at u = 385..437,
  // of which the blocker itself hides u > 407.
  const float lit = test::encoded(0.6F);
  EXPECT_NEAR(at(images.rgb, 300, 240), lit, 3.0F);
  EXPECT_NEAR(at(images.rgb, 395, 240), test::encoded(0.1F), 2.0F);
  EXPECT_NEAR(at(images.rgb, 440, 240), lit, 3.0F);
  EXPECT_EQ(at(images.labels, 440, 240), 2);
  EXPECT_NEAR(at(images.rgb, 480, 240), lit, 3.0F);
}

TEST(Opaque, SurfacesAreKnownAgainByContent) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  OpaqueScene scene;
  scene.light = Light::uniform(glm::vec3(0.3F), no_sun());
  scene.surfaces.push_back(quad({-1, 1, 4}, {2, 0, 0}, {0, -2, 0}, 3));
  const OpaqueImages first = renderer.draw_opaque(scene, camera);
  const OpaqueImages again = renderer.draw_opaque(scene, camera);
  EXPECT_EQ(first.rgb.pixels, again.rgb.pixels);
  EXPECT_EQ(first.depth.pixels, again.depth.pixels);
  for (glm::vec3& p : scene.surfaces[0].positions) p.z += 1.0F;  // same address, other content
  const OpaqueImages moved = renderer.draw_opaque(scene, camera);
  EXPECT_NEAR(at(moved.depth, 320, 240), 5.0F, 1e-4F);
}

TEST(Opaque, IndicesBeyondTheVerticesAreLeftOut) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  OpaqueScene scene;
  scene.light = Light::uniform(glm::vec3(0.3F), no_sun());
  scene.surfaces.push_back(quad({-1, 1, 4}, {2, 0, 0}, {0, -2, 0}, 3));
  scene.surfaces[0].indices.insert(scene.surfaces[0].indices.end(), {0, 1, 4000000000U});
  EXPECT_EQ(at(renderer.draw_opaque(scene, camera).labels, 320, 240), 3);
}

}  // namespace
}  // namespace planecast::render
