#include <gtest/gtest.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "ball.h"
#include "render/gltf/simplify.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

using test::at;

constexpr float kPi = 3.14159265F;

float linear(float encoded_255) {
  const float c = encoded_255 / 255.0F;
  return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

/// What half a grey level is worth in linear light.
float half_level(float value) {
  const float level = test::encoded(value);
  return 0.5F * (linear(level + 0.5F) - linear(level - 0.5F)) + 1e-4F;
}

/// Reflects diffusely alone: no specular layer (KHR_materials_specular of 0).
Material lambertian(const glm::vec3& albedo) {
  Material material = test::matte(albedo);
  material.specular = 0.0F;
  return material;
}

Instance at_distance(const std::shared_ptr<const Model>& model, float z) {
  Instance instance;
  instance.model = model;
  instance.world_from_model = glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, z));
  return instance;
}

/// Radiance of an environment of spherical harmonics; the basis written out once more.
glm::vec3 radiance(const std::array<glm::vec3, 9>& sh, const glm::vec3& d) {
  const std::array<float, 9> basis = {0.5F * std::sqrt(1.0F / kPi),
                                      std::sqrt(0.75F / kPi) * d.y,
                                      std::sqrt(0.75F / kPi) * d.z,
                                      std::sqrt(0.75F / kPi) * d.x,
                                      0.5F * std::sqrt(15.0F / kPi) * d.x * d.y,
                                      0.5F * std::sqrt(15.0F / kPi) * d.y * d.z,
                                      0.25F * std::sqrt(5.0F / kPi) * (3.0F * d.z * d.z - 1.0F),
                                      0.5F * std::sqrt(15.0F / kPi) * d.x * d.z,
                                      0.25F * std::sqrt(15.0F / kPi) * (d.x * d.x - d.y * d.y)};
  glm::vec3 sum(0.0F);
  for (std::size_t i = 0; i < 9; ++i) sum += basis[i] * sh[i];
  return sum;
}

/// Integral of the radiance over the hemisphere with its cosine, over pi.
glm::vec3 irradiance_over_pi(const std::array<glm::vec3, 9>& sh, const glm::vec3& n) {
  const glm::vec3 helper = std::abs(n.x) < 0.9F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 a = glm::normalize(glm::cross(n, helper));
  const glm::vec3 b = glm::cross(n, a);
  constexpr int kPolar = 48;
  constexpr int kAround = 96;
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kPolar; ++i) {
    // Equal steps of the cosine's square have equal weight.
    const float cosine = std::sqrt((static_cast<float>(i) + 0.5F) / kPolar);
    const float sine = std::sqrt(1.0F - cosine * cosine);
    for (int j = 0; j < kAround; ++j) {
      const float angle = 2.0F * kPi * (static_cast<float>(j) + 0.5F) / kAround;
      sum +=
          glm::dvec3(radiance(sh, cosine * n + sine * (std::cos(angle) * a + std::sin(angle) * b)));
    }
  }
  return glm::vec3(sum / static_cast<double>(kPolar * kAround));
}

TEST(KnownLight, LambertianSphereIsWithinOnePerCentOfTheIntegral) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  LayerScene scene;
  const glm::vec3 albedo(0.8F, 0.7F, 0.6F);
  scene.instances.push_back(at_distance(
      test::one_primitive_model(test::sphere_primitive(0.5F, 96), lambertian(albedo)), 2.0F));
  scene.light = Light::uniform(glm::vec3(0.5F), test::no_sun());
  scene.light.ambient_sh[1] = glm::vec3(0.2F, -0.15F, 0.1F);
  scene.light.ambient_sh[2] = glm::vec3(-0.1F, 0.1F, 0.2F);
  scene.light.ambient_sh[3] = glm::vec3(0.15F, 0.1F, -0.1F);
  scene.light.ambient_sh[4] = glm::vec3(0.1F, 0.05F, 0.1F);
  scene.light.ambient_sh[6] = glm::vec3(-0.1F, 0.1F, 0.05F);
  scene.light.ambient_sh[8] = glm::vec3(0.1F, -0.05F, 0.1F);
  const Layer layer = renderer.draw_layer(scene, camera);
  double error = 0.0;
  int count = 0;
  test::over_the_ball(camera, [&](int u, int v, const glm::vec3& n, const glm::vec3&) {
    const glm::vec3 expected = albedo * irradiance_over_pi(scene.light.ambient_sh, n);
    for (int c = 0; c < 3; ++c) {
      const float found = linear(at(layer.rgba, u, v, c));
      EXPECT_NEAR(found, expected[c], 0.01F * expected[c] + half_level(expected[c]))
          << u << " " << v << " " << c;
      error += std::abs(found - expected[c]) / expected[c];
      ++count;
    }
  });
  ASSERT_GT(count, 200);
  EXPECT_LT(error / count, 0.01);
}

/// A square facing the camera at z = 1 with tangent +x, in a picture of 16 x 16; pixel (8, 8) looks
/// straight at it.
Layer draw_square(Renderer& renderer, const std::shared_ptr<Model>& model, const Light& light) {
  Camera camera;
  camera.width = camera.height = 16;
  camera.fx = camera.fy = 40.0F;
  camera.cx = camera.cy = 8.0F;
  LayerScene scene;
  scene.instances.push_back(at_distance(model, 1.0F));
  scene.light = light;
  return renderer.draw_layer(scene, camera);
}

std::shared_ptr<Model> square_model(const Material& material, float handedness = 1.0F) {
  Primitive square;
  for (const glm::vec2 corner :
       {glm::vec2(-1, 1), glm::vec2(1, 1), glm::vec2(1, -1), glm::vec2(-1, -1)}) {
    // y runs down in the camera's frame, which is the world here; the normal faces the camera.
    square.shape.push_back(
        {glm::vec3(corner, 0.0F), glm::vec3(0, 0, -1), glm::vec4(1, 0, 0, handedness)});
    square.surface.emplace_back();
  }
  square.indices = {0, 1, 2, 0, 2, 3};
  square.box = {glm::vec3(-1, -1, 0), glm::vec3(1, 1, 0)};
  return test::one_primitive_model(square, material);
}

Sun sun_from(const glm::vec3& direction, float strength) {
  Sun sun;
  sun.direction_to_light = direction;
  sun.radiance = glm::vec3(strength);
  sun.casts_shadow = false;
  return sun;
}

TEST(KnownLight, SunOnALambertianSquareFollowsTheCosine) {
  Renderer renderer(test::renderer_options());
  for (const float degrees : {0.0F, 30.0F, 60.0F, 80.0F}) {
    const float angle = degrees * kPi / 180.0F;
    const glm::vec3 to_light(std::sin(angle), 0.0F, -std::cos(angle));
    const Layer layer = draw_square(renderer, square_model(lambertian(glm::vec3(0.8F))),
                                    Light::uniform(glm::vec3(0.0F), sun_from(to_light, 1.0F)));
    const float expected = 0.8F * std::cos(angle);
    EXPECT_NEAR(linear(at(layer.rgba, 8, 8)), expected, 0.01F * expected + half_level(expected));
  }
}

TEST(KnownLight, NormalMapTurnsTheSurfaceByItsTangentFrame) {
  Renderer renderer(test::renderer_options());
  for (const float handedness : {1.0F, -1.0F}) {
    for (const glm::vec3 local :
         {glm::vec3(0.5F, 0, 0.866F), glm::vec3(0, 0.5F, 0.866F), glm::vec3(-0.3F, 0.4F, 0.866F)}) {
      Material material = lambertian(glm::vec3(0.8F));
      material.normal_map.texture = 0;
      const auto model = square_model(material, handedness);
      ImageU8 image(1, 1, 3);
      for (int c = 0; c < 3; ++c) {
        image.pixels[static_cast<std::size_t>(c)] =
            static_cast<std::uint8_t>(std::lround(127.5F * (local[c] + 1.0F)));
      }
      model->images = {image};
      model->textures.emplace_back().image = 0;
      const glm::vec3 to_light = glm::normalize(glm::vec3(0.4F, -0.3F, -1.0F));
      const Layer layer =
          draw_square(renderer, model, Light::uniform(glm::vec3(0.0F), sun_from(to_light, 1.0F)));
      // Tangent (1, 0, 0), bitangent cross(normal, tangent) * w (glTF 2.0, 3.7.2.1).
      const glm::vec3 normal(0, 0, -1);
      const glm::vec3 tangent(1, 0, 0);
      const glm::vec3 n =
          glm::normalize(local.x * tangent + local.y * handedness * glm::cross(normal, tangent) +
                         local.z * normal);
      const float expected = 0.8F * glm::dot(n, to_light);
      // Half a step of a byte in each component of the normal is 0.004.
      EXPECT_NEAR(linear(at(layer.rgba, 8, 8)), expected, 0.006F + half_level(expected))
          << handedness << " " << local.x << " " << local.y;
    }
  }
}

/// Share of a sun over the whole hemisphere that a white metal sends to an eye in front of it:
/// GGX and height-correlated Smith of glTF 2.0, appendix B, by itself; F is 1.
double ggx_albedo(double alpha) {
  constexpr int kSteps = 4000;
  double sum = 0.0;
  const double a2 = alpha * alpha;
  for (int i = 0; i < kSteps; ++i) {
    const double l = (i + 0.5) / kSteps;  // cosine of the light; the eye's is 1
    const double h = std::sqrt(0.5 * (1.0 + l));
    const double d = a2 / (kPi * std::pow(h * h * (a2 - 1.0) + 1.0, 2.0));
    const double v = 0.5 / (l + std::sqrt(l * l * (1.0 - a2) + a2));
    sum += d * v * l * 2.0 * kPi / kSteps;
  }
  return sum;
}

TEST(KnownLight, MetalReflectsWhatTheMicrofacetModelSaysAndNeverMore) {
  Renderer renderer(test::renderer_options());
  for (const float roughness : {0.5F, 0.75F, 1.0F}) {
    Material material = test::matte(glm::vec3(1.0F));
    material.metallic = 1.0F;
    material.roughness = roughness;
    const auto model = square_model(material);
    constexpr int kSteps = 48;
    // Keeps the brightest direction below the end of the scale.
    const float strength = 1.5F * std::pow(roughness, 4.0F);
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const float cosine = (static_cast<float>(i) + 0.5F) / kSteps;
      const glm::vec3 to_light(std::sqrt(1.0F - cosine * cosine), 0.0F, -cosine);
      const Layer layer = draw_square(
          renderer, model, Light::uniform(glm::vec3(0.0F), sun_from(to_light, strength)));
      // The sun's radiance is irradiance / pi, and directions around the normal are alike.
      sum += 2.0 * static_cast<double>(linear(at(layer.rgba, 8, 8)) / strength) / kSteps;
    }
    EXPECT_NEAR(sum, ggx_albedo(roughness * roughness), 0.015) << roughness;
    EXPECT_LE(sum, 1.0) << roughness;
  }
}

/// Layers on top of a white material may take light away, never add to it.
TEST(KnownLight, LayersGainNothingInTheWhiteFurnace) {
  Renderer renderer(test::renderer_options());
  const auto furnace = [&](const Material& material) {
    Camera camera;
    LayerScene scene;
    scene.instances.push_back(
        at_distance(test::one_primitive_model(test::sphere_primitive(0.5F), material), 2.0F));
    scene.light = Light::uniform(glm::vec3(0.5F), test::no_sun());
    const Layer layer = renderer.draw_layer(scene, camera);
    float brightest = 0.0F;
    for (const int offset : {0, 40, 80, 110}) {
      brightest = std::max(brightest, linear(at(layer.rgba, 320 + offset, 240)) / 0.5F);
    }
    return brightest;
  };
  // One grey level is 0.9 % there; the fits of the layers' albedos are good to 1 % (coat), 4 %
  // (sheen, at grazing angles).
  Material coated = test::matte(glm::vec3(1.0F));
  coated.clearcoat = 1.0F;
  EXPECT_LE(furnace(coated), 1.02F);
  EXPECT_GE(furnace(coated), 0.95F);
  Material cloth = test::matte(glm::vec3(1.0F));
  cloth.sheen_color = glm::vec3(1.0F);
  cloth.sheen_roughness = 0.5F;
  EXPECT_LE(furnace(cloth), 1.02F);
  EXPECT_GE(furnace(cloth), 0.9F);
  Material no_specular = lambertian(glm::vec3(1.0F));
  EXPECT_LE(furnace(no_specular), 1.01F);
}

TEST(Simplify, StaysWithinHalfAPixelOnTheScreen) {
  Primitive ball = test::sphere_primitive(0.5F, 100);
  add_detail_levels(ball);
  ASSERT_GE(ball.details.size(), 3U);
  for (std::size_t i = 1; i < ball.details.size(); ++i) {
    EXPECT_LT(ball.details[i].indices.size(), ball.details[i - 1].indices.size());
  }
  const auto model = test::one_primitive_model(ball, test::matte(glm::vec3(0.7F)));
  RendererOptions options = test::renderer_options();
  Renderer coarse(options);
  options.simplify_px = 0.0F;
  Renderer exact(options);
  Camera camera;
  for (const float z : {1.2F, 2.5F, 6.0F}) {
    LayerScene scene;
    scene.instances.push_back(at_distance(model, z));
    scene.light = Light::uniform(glm::vec3(0.5F), test::no_sun());
    const Layer a = coarse.draw_layer(scene, camera);
    const Layer b = exact.draw_layer(scene, camera);
    // An outline that has moved by half a pixel changes its pixels' coverage by a half; another
    // quarter is the step of four samples.
    int beyond = 0;
    int changed = 0;
    for (std::size_t i = 3; i < a.rgba.pixels.size(); i += 4) {
      const int difference = std::abs(a.rgba.pixels[i] - b.rgba.pixels[i]);
      beyond += difference > 192 ? 1 : 0;
      changed += difference > 0 ? 1 : 0;
    }
    EXPECT_EQ(beyond, 0) << z;
    EXPECT_GT(changed, 0) << "nothing was simplified at " << z;
  }
}

TEST(Layer, BakedShadowsLookAsComputedOnes) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  const auto model =
      test::one_primitive_model(test::box_primitive(glm::vec3(0.1F)), test::matte(glm::vec3(0.7F)));
  // Something that could move is never baked, whether it does or not.
  const auto movable = std::make_shared<Model>(*model);
  movable->animations.emplace_back();
  LayerScene scene;
  scene.instances.push_back(at_distance(model, 1.5F));
  PlanePatch floor;
  floor.normal = {0, -1, 0};
  floor.outer = {{-1, 0.1F, 0.7F}, {-1, 0.1F, 2.5F}, {1, 0.1F, 2.5F}, {1, 0.1F, 0.7F}};
  scene.catchers.push_back(floor);
  camera.camera_from_world = glm::rotate(glm::mat4(1.0F), 0.45F, glm::vec3(1, 0, 0)) *
                             glm::translate(glm::mat4(1.0F), glm::vec3(0, 0.6F, 0));
  Sun sun;
  sun.direction_to_light = glm::normalize(glm::vec3(0.6F, -1.0F, 0.2F));
  scene.light = Light::uniform(glm::vec3(0.5F), sun);
  const Layer baked = renderer.draw_layer(scene, camera);
  scene.instances[0].model = movable;
  scene.instances[0].animation = 0;
  const Layer computed = renderer.draw_layer(scene, camera);
  int dark = 0;
  int different = 0;
  for (std::size_t i = 3; i < baked.rgba.pixels.size(); i += 4) {
    dark += computed.rgba.pixels[i] > 20 ? 1 : 0;
    // Three grey levels: a byte in the map, its steeper encoding in dark places, and filtering.
    different += std::abs(baked.rgba.pixels[i] - computed.rgba.pixels[i]) > 3 ? 1 : 0;
  }
  ASSERT_GT(dark, 3000);
  EXPECT_LT(different, dark / 200);
}

}  // namespace
}  // namespace planecast::render
