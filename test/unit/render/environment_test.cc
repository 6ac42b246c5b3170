#include "render/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "ball.h"
#include "render/renderer.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

template <typename Radiance>
ImageF map_of(int height, const Radiance& radiance) {
  ImageF map(2 * height, height, 3);
  float* out = map.pixels.data();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < 2 * height; ++x) {
      const glm::vec2 place = (glm::vec2(x, y) + 0.5F) / glm::vec2(2 * height, height);
      const glm::vec3 value = radiance(equirectangular_direction(place));
      for (int c = 0; c < 3; ++c) *out++ = value[c];
    }
  }
  return map;
}

const std::vector<glm::vec3> kDirections = {
    {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0.6F, 0.8F, 0}, {0, 0.6F, -0.8F}};

TEST(Environment, WhiteStaysWhiteAtEveryRoughness) {
  const Environment white(map_of(64, [](const glm::vec3&) { return glm::vec3(0.7F); }));
  EXPECT_EQ(white.levels(), 6);
  for (int level = 0; level < white.levels(); ++level) {
    for (const glm::vec3& texel : white.texels(level)) EXPECT_NEAR(texel.g, 0.7F, 1e-4F);
  }
  const auto sh = white.harmonics(glm::mat3(1.0F));
  EXPECT_NEAR(sh[0].r * 0.282095F, 0.7F, 0.002F);
  for (std::size_t i = 1; i < 9; ++i) EXPECT_NEAR(sh[i].r, 0.0F, 0.002F);
}

/// The middle column is -z, +x is right of it, up is the first row.
TEST(Environment, DirectionsAreTheMaps) {
  EXPECT_NEAR(equirectangular_direction({0.5F, 0.5F}).z, -1.0F, 1e-6F);
  EXPECT_NEAR(equirectangular_direction({0.75F, 0.5F}).x, 1.0F, 1e-6F);
  EXPECT_NEAR(equirectangular_direction({0.3F, 0.0F}).y, 1.0F, 1e-6F);
  const Environment ramp(map_of(256, [](const glm::vec3& d) { return 0.5F + 0.5F * d; }));
  for (const glm::vec3& d : kDirections) {
    const glm::vec3 found = ramp.radiance(d, 0.0F);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], 0.5F + 0.5F * d[c], 0.01F);
  }
}

/// A lobe of GGX with view = normal, integrated over a fine grid, weighted by the cosine.
float blurred_ramp(float roughness) {
  const double a2 = std::pow(static_cast<double>(roughness), 4.0);
  double sum = 0.0;
  double weight = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) / kSteps;
    const double cos2 = (1.0 - x) / (1.0 + (a2 - 1.0) * x);
    const double to_light = 2.0 * cos2 - 1.0;
    if (to_light <= 0.0) continue;
    sum += to_light * to_light;
    weight += to_light;
  }
  return static_cast<float>(sum / weight);
}

/// Of the radiance d.y only the mean cosine of the lobe is left.
TEST(Environment, LevelsAreBlurredByTheLobeOfTheirRoughness) {
  const Environment ramp(map_of(256, [](const glm::vec3& d) { return glm::vec3(1.0F + d.y); }));
  for (int level = 1; level < ramp.levels(); ++level) {
    const float roughness = static_cast<float>(level) / static_cast<float>(ramp.levels() - 1);
    const float kept = blurred_ramp(roughness);
    // Texels about the pole look up to half of one aside.
    const float tolerance = 0.02F + 2.0F / static_cast<float>(ramp.side(level) * ramp.side(level));
    EXPECT_NEAR(ramp.radiance({0, 1, 0}, roughness).r, 1.0F + kept, tolerance) << level;
    EXPECT_NEAR(ramp.radiance({0, -1, 0}, roughness).r, 1.0F - kept, tolerance) << level;
  }
}

TEST(Environment, WhatIsNoLightIsBlackAndOddMapsAreRefused) {
  ImageF map = map_of(16, [](const glm::vec3&) { return glm::vec3(1.0F); });
  for (std::size_t i = 0; i < map.pixels.size(); i += 5) {
    map.pixels[i] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : -3.0F;
  }
  const Environment broken(map);
  for (const glm::vec3& texel : broken.texels(3)) {
    EXPECT_TRUE(texel.r >= 0.0F && texel.r <= 1.001F);
  }
  EXPECT_THROW(Environment{ImageF()}, std::invalid_argument);
  EXPECT_THROW((Environment{ImageF(4, 2, 1)}), std::invalid_argument);
}

float linear(int encoded) {
  const float c = static_cast<float>(encoded) / 255.0F;
  return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

Instance ball(const Material& material) {
  Instance instance;
  instance.model = test::one_primitive_model(test::sphere_primitive(0.5F, 96), material);
  instance.world_from_model = glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 2));
  return instance;
}

LayerScene lit_by(const Material& material, const Environment& environment,
                  const glm::mat3& map_from_world) {
  LayerScene scene;
  scene.instances = {ball(material)};
  scene.light = Light::uniform(glm::vec3(0.0F), test::no_sun());
  scene.light.ambient_sh = environment.harmonics(map_from_world);
  scene.light.environment = std::make_shared<Environment>(environment);
  scene.light.environment_from_world = map_from_world;
  return scene;
}

/// The world's y runs down in these pictures.
const glm::mat3 kUpright(glm::vec3(1, 0, 0), glm::vec3(0, -1, 0), glm::vec3(0, 0, -1));

/// Light from the upper half alone: irradiance / pi is (1 + n.y) / 2.
TEST(EnvironmentLight, LambertianSphereUnderAHalfSkyIsWithinOnePerCent) {
  const Environment sky(
      map_of(256, [](const glm::vec3& d) { return glm::vec3(d.y > 0.0F ? 0.9F : 0.0F); }));
  Material matt = test::matte(glm::vec3(0.8F));
  matt.specular = 0.0F;
  Renderer renderer(test::renderer_options());
  const Camera camera;
  const Layer layer = renderer.draw_layer(lit_by(matt, sky, kUpright), camera);
  test::over_the_ball(camera, [&](int u, int v, const glm::vec3& n, const glm::vec3&) {
    const float expected = 0.8F * 0.9F * 0.5F * (1.0F - n.y);
    const float half_level = 0.5F * (linear(200) - linear(199));
    EXPECT_NEAR(linear(test::at(layer.rgba, u, v, 1)), expected, 0.01F * expected + half_level);
  });
}

TEST(EnvironmentLight, NothingIsLostOrGainedInAWhiteFurnace) {
  const Environment white(map_of(64, [](const glm::vec3&) { return glm::vec3(0.5F); }));
  Renderer renderer(test::renderer_options());
  const Camera camera;
  for (const float roughness : {0.0F, 0.3F, 0.6F, 1.0F}) {
    Material metal;
    metal.metallic = 1.0F;
    metal.roughness = roughness;
    const Layer layer = renderer.draw_layer(lit_by(metal, white, kUpright), camera);
    test::over_the_ball(camera, [&](int u, int v, const glm::vec3&, const glm::vec3&) {
      EXPECT_NEAR(linear(test::at(layer.rgba, u, v, 1)), 0.5F, 0.01F) << roughness;
    });
  }
}

/// A mirror shows the map where the ray is reflected to.
TEST(EnvironmentLight, AMirrorShowsTheSurroundings) {
  const Environment ramp(map_of(256, [](const glm::vec3& d) { return 0.4F + 0.3F * d; }));
  Material mirror;
  mirror.metallic = 1.0F;
  mirror.roughness = 0.0F;
  Renderer renderer(test::renderer_options());
  const Camera camera;
  const Layer layer = renderer.draw_layer(lit_by(mirror, ramp, kUpright), camera);
  test::over_the_ball(camera, [&](int u, int v, const glm::vec3& n, const glm::vec3& ray) {
    const glm::vec3 seen = kUpright * glm::reflect(ray, n);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(linear(test::at(layer.rgba, u, v, c)), 0.4F + 0.3F * seen[c], 0.015F);
    }
  });
}

TEST(EnvironmentLight, NeutralToneMapKeepsColoursAndCompressesLight) {
  const Environment white(map_of(64, [](const glm::vec3&) { return glm::vec3(1.0F); }));
  Material matt = test::matte(glm::vec3(0.5F, 0.3F, 0.3F));
  matt.unlit = true;
  Renderer renderer(test::renderer_options());
  const Camera camera;
  LayerScene scene = lit_by(matt, white, kUpright);
  const auto middle = [&](float exposure) {
    scene.exposure = exposure;
    scene.tone_map = ToneMap::kNeutral;
    const Layer layer = renderer.draw_layer(scene, camera);
    return glm::vec3(linear(test::at(layer.rgba, 320, 240, 0)),
                     linear(test::at(layer.rgba, 320, 240, 1)),
                     linear(test::at(layer.rgba, 320, 240, 2)));
  };
  EXPECT_NEAR(middle(1.0F).r, 0.46F, 0.005F) << "less by the reflection of a dielectric";
  EXPECT_NEAR(middle(1.0F).g, 0.26F, 0.005F);
  const glm::vec3 bright = middle(4.0F);
  EXPECT_LT(bright.r, 1.0F);
  EXPECT_GT(bright.r, 0.9F);
  EXPECT_GT(bright.g, 0.6F * bright.r) << "whiter";
}

}  // namespace
}  // namespace planecast::render
