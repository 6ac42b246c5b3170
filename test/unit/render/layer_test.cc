#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/renderer.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

using test::at;
using test::no_sun;

/// Looks down at the floor y = 0 (y being down) from a metre above it and a metre before the
/// origin.
Camera downward_camera() {
  Camera camera;
  glm::mat4 m = glm::rotate(glm::mat4(1.0F), glm::radians(45.0F), glm::vec3(1, 0, 0));
  m = glm::translate(m, glm::vec3(0, 1, 1));
  camera.camera_from_world = m;
  return camera;
}

glm::vec3 in_camera(const Camera& camera, const glm::vec3& world) {
  return glm::vec3(camera.camera_from_world * glm::vec4(world, 1.0F));
}

glm::ivec2 pixel_of(const Camera& camera, const glm::vec3& world) {
  const glm::vec3 p = in_camera(camera, world);
  return {static_cast<int>(std::lround(camera.fx * p.x / p.z + camera.cx)),
          static_cast<int>(std::lround(camera.fy * p.y / p.z + camera.cy))};
}

/// Where the pixel's ray meets the floor.
glm::vec3 floor_point(const Camera& camera, int u, int v) {
  const glm::mat4 world_from_camera = glm::inverse(camera.camera_from_world);
  const glm::vec3 ray((static_cast<float>(u) - camera.cx) / camera.fx,
                      (static_cast<float>(v) - camera.cy) / camera.fy, 1.0F);
  const glm::vec3 eye(world_from_camera[3]);
  const glm::vec3 direction = glm::mat3(world_from_camera) * ray;
  return eye - direction * (eye.y / direction.y);
}

PlanePatch floor_patch(float half) {
  PlanePatch patch;
  patch.normal = {0, -1, 0};
  patch.outer = {{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}};
  return patch;
}

Instance box_at(const glm::vec3& center, const glm::vec3& half) {
  Instance instance;
  instance.model =
      test::one_primitive_model(test::box_primitive(half), test::matte(glm::vec3(0.5F)));
  instance.world_from_model = glm::translate(glm::mat4(1.0F), center);
  return instance;
}

/// A box on the floor under a sun from above, and a floor to catch its shadow.
LayerScene box_scene() {
  LayerScene scene;
  scene.instances.push_back(box_at({0, -0.1F, 0}, glm::vec3(0.1F)));
  scene.catchers.push_back(floor_patch(1.0F));
  Sun sun;
  sun.direction_to_light = glm::normalize(glm::vec3(-0.5F, -1.0F, 0.0F));
  sun.radiance = glm::vec3(0.6F);
  scene.light = Light::uniform(glm::vec3(0.3F), sun);
  return scene;
}

TEST(Layer, IsPremultipliedAndEmptyOutsideItsBounds) {
  Renderer renderer(test::renderer_options());
  const LayerScene scene = box_scene();
  const Layer layer = renderer.draw_layer(scene, downward_camera());
  const Layer::Rect& box = layer.bounds;
  ASSERT_GT(box.width, 0);
  int covered = 0;
  for (int v = 0; v < layer.rgba.height; ++v) {
    for (int u = 0; u < layer.rgba.width; ++u) {
      const int alpha = at(layer.rgba, u, v, 3);
      for (int c = 0; c < 3; ++c) ASSERT_LE(at(layer.rgba, u, v, c), alpha);
      const bool inside =
          u >= box.x && u < box.x + box.width && v >= box.y && v < box.y + box.height;
      if (!inside) {
        ASSERT_EQ(alpha, 0);
        ASSERT_EQ(at(layer.depth, u, v), 0.0F);
      }
      covered += alpha == 255 ? 1 : 0;
    }
  }
  EXPECT_GT(covered, 5000);
}

TEST(Layer, CatcherDarkensBesideTheObjectAndNowhereElse) {
  Renderer renderer(test::renderer_options());
  const Camera camera = downward_camera();
  const Layer layer = renderer.draw_layer(box_scene(), camera);
  // The sun comes from -x at a slope of two: the box of height 0.2 throws 0.1 of shadow to x = 0.2.
  const glm::ivec2 shade = pixel_of(camera, {0.15F, 0, 0});
  const glm::ivec2 lit = pixel_of(camera, {-0.6F, 0, 0});
  EXPECT_GT(at(layer.rgba, shade.x, shade.y, 3), 60);
  EXPECT_EQ(at(layer.rgba, shade.x, shade.y, 0), 0);
  EXPECT_EQ(at(layer.depth, shade.x, shade.y), 0.0F);
  EXPECT_EQ(at(layer.rgba, lit.x, lit.y, 3), 0);
  const glm::ivec2 top = pixel_of(camera, {0, -0.2F, 0});
  EXPECT_EQ(at(layer.rgba, top.x, top.y, 3), 255);
  EXPECT_GT(at(layer.rgba, top.x, top.y, 0), 100);
}

TEST(Layer, ShadowFallsWhereTheGeometrySaysAndIsAsDarkAsTheLight) {
  Renderer renderer(test::renderer_options());
  const Camera camera = downward_camera();
  LayerScene scene;
  // A board so high over the plane that it leaves no contact shadow.
  constexpr float kHeight = 0.3F;
  scene.instances.push_back(box_at({0, -kHeight, 0.6F}, {0.1F, 0.002F, 0.1F}));
  scene.catchers.push_back(floor_patch(2.0F));
  Sun sun;
  sun.direction_to_light = glm::normalize(glm::vec3(-1.0F, -1.0F, 1.0F));
  sun.radiance = glm::vec3(0.9F);
  sun.angular_radius_rad = 0.005F;
  scene.light = Light::uniform(glm::vec3(0.4F), sun);
  const Layer layer = renderer.draw_layer(scene, camera);

  // Mean of the floor under the shadow's pixels, weighted by their size on the floor.
  glm::dvec3 mean(0.0);
  double weight = 0.0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (at(layer.rgba, u, v, 3) == 0 || at(layer.rgba, u, v, 0) > 0) continue;
      const glm::vec3 p = floor_point(camera, u, v);
      const double z = in_camera(camera, p).z;
      const double w = z * z * z * at(layer.rgba, u, v, 3);
      mean += w * glm::dvec3(p);
      weight += w;
    }
  }
  ASSERT_GT(weight, 0.0);
  mean /= weight;
  // Two shadow texels and half a floor pixel are 2 mm here.
  EXPECT_NEAR(mean.x, kHeight, 0.003);
  EXPECT_NEAR(mean.z, 0.6 - kHeight, 0.003);

  const glm::ivec2 middle = pixel_of(camera, {kHeight, 0, 0.6F - kHeight});
  const float sun_part = 0.9F / std::sqrt(3.0F);
  const float expected = 255.0F * (1.0F - std::pow(0.4F / (0.4F + sun_part), 1.0F / 2.2F));
  EXPECT_NEAR(at(layer.rgba, middle.x, middle.y, 3), expected, 3.0F);
}

TEST(Layer, ShadowStaysOnThePolygonAndOutOfItsHoles) {
  Renderer renderer(test::renderer_options());
  const Camera camera = downward_camera();
  LayerScene scene = box_scene();
  PlanePatch& patch = scene.catchers[0];
  patch.outer = {{-1, 0, -1}, {-1, 0, 1}, {0.17F, 0, 1}, {0.17F, 0, -1}};
  patch.holes = {{{0.11F, 0, -0.05F}, {0.11F, 0, 0.05F}, {0.16F, 0, 0.05F}, {0.16F, 0, -0.05F}}};
  patch.edge_softness_m = 0.005F;
  const Layer layer = renderer.draw_layer(scene, camera);
  const glm::ivec2 beyond = pixel_of(camera, {0.185F, 0, 0});
  const glm::ivec2 hole = pixel_of(camera, {0.14F, 0, 0});
  const glm::ivec2 kept = pixel_of(camera, {0.13F, 0, -0.075F});
  EXPECT_EQ(at(layer.rgba, beyond.x, beyond.y, 3), 0);
  EXPECT_EQ(at(layer.rgba, hole.x, hole.y, 3), 0);
  EXPECT_GT(at(layer.rgba, kept.x, kept.y, 3), 60);
}

TEST(Layer, ContactShadowNeedsNoSun) {
  Renderer renderer(test::renderer_options());
  const Camera camera = downward_camera();
  LayerScene scene = box_scene();
  scene.light.sun = no_sun();
  const Layer layer = renderer.draw_layer(scene, camera);
  const auto alpha_at = [&](float x) {
    const glm::ivec2 p = pixel_of(camera, {x, 0, 0});
    return static_cast<int>(at(layer.rgba, p.x, p.y, 3));
  };
  // An endless wall at no distance would take half of the light, alpha 69 of 255.
  EXPECT_GT(alpha_at(0.12F), 25);
  EXPECT_LT(alpha_at(0.12F), 69);
  EXPECT_GT(alpha_at(0.12F), alpha_at(0.16F));
  EXPECT_GT(alpha_at(0.16F), alpha_at(0.25F));
  EXPECT_NEAR(alpha_at(0.13F), alpha_at(-0.13F), 6);
}

TEST(Layer, NoShadowAtStrengthNoneOrFromBelow) {
  Renderer renderer(test::renderer_options());
  LayerScene scene = box_scene();
  scene.shadow_strength = 0.0F;
  const Camera camera = downward_camera();
  Layer layer = renderer.draw_layer(scene, camera);
  const glm::ivec2 shade = pixel_of(camera, {0.15F, 0, 0});
  EXPECT_EQ(at(layer.rgba, shade.x, shade.y, 3), 0);
  scene.shadow_strength = 1.0F;
  scene.catchers[0].normal = {0, 1, 0};
  layer = renderer.draw_layer(scene, camera);
  EXPECT_EQ(at(layer.rgba, shade.x, shade.y, 3), 0);
}

TEST(Layer, OccluderPolygonHidesObjectAndShadow) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  LayerScene scene;
  scene.instances.push_back(box_at({0, 0, 2}, glm::vec3(0.3F)));
  scene.light = Light::uniform(glm::vec3(0.5F), no_sun());
  // Concave, before the left half of the box, with a hole that shows some of it.
  PlanePatch patch;
  patch.normal = {0, 0, -1};
  patch.outer = {{-1, -1, 1}, {0, -1, 1}, {0, 1, 1}, {-1, 1, 1}, {-0.5F, 0, 1}};
  patch.holes = {{{-0.1F, -0.05F, 1}, {-0.05F, -0.05F, 1}, {-0.05F, 0.05F, 1}, {-0.1F, 0.05F, 1}}};
  scene.occluders.push_back(patch);
  const Layer layer = renderer.draw_layer(scene, camera);
  const int v = 240;
  EXPECT_EQ(at(layer.rgba, 305, v, 3), 0);
  EXPECT_EQ(at(layer.depth, 305, v), 0.0F);
  EXPECT_EQ(at(layer.rgba, 335, v, 3), 255);
  EXPECT_NEAR(at(layer.depth, 335, v), 1.7F, 1e-4F);
  EXPECT_EQ(at(layer.rgba, 280, v, 3), 255);  // through the hole
  EXPECT_EQ(at(layer.rgba, 280, 290, 3), 0);
  // Behind the object it hides nothing.
  for (glm::vec3& point : scene.occluders[0].outer) point.z = 3.0F;
  scene.occluders[0].holes.clear();
  const Layer free = renderer.draw_layer(scene, camera);
  EXPECT_EQ(at(free.rgba, 305, v, 3), 255);
}

TEST(Layer, ObjectOnAnOccludingPlaneIsNotCut) {
  Renderer renderer(test::renderer_options());
  const Camera camera = downward_camera();
  LayerScene scene = box_scene();
  const Layer without = renderer.draw_layer(scene, camera);
  scene.occluders.push_back(scene.catchers[0]);
  const Layer with = renderer.draw_layer(scene, camera);
  EXPECT_EQ(without.rgba.pixels, with.rgba.pixels);
}

TEST(Layer, OccluderDepthHidesSoftlyAndUnknownDepthDoesNot) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  LayerScene scene;
  scene.instances.push_back(box_at({0, 0, 2}, glm::vec3(0.3F)));
  scene.light = Light::uniform(glm::vec3(0.5F), no_sun());
  ImageF depth(camera.width, camera.height, 1);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      float& z = depth.pixels[static_cast<std::size_t>(v * camera.width + u)];
      z = u < 300 ? 1.0F : u < 320 ? 0.0F : u < 340 ? 1.7F / 1.01F : 5.0F;
    }
  }
  scene.occluder_depth = &depth;
  const Layer layer = renderer.draw_layer(scene, camera);
  EXPECT_EQ(at(layer.rgba, 280, 240, 3), 0);
  EXPECT_EQ(at(layer.depth, 280, 240), 0.0F);
  EXPECT_EQ(at(layer.rgba, 310, 240, 3), 255);
  EXPECT_NEAR(at(layer.rgba, 330, 240, 3), 127, 8);  // one of the two per cent of tolerance behind
  EXPECT_EQ(at(layer.rgba, 360, 240, 3), 255);
}

TEST(Layer, BlendedMaterialLetsTheVideoThrough) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  LayerScene scene;
  Material glass = test::matte(glm::vec3(1.0F));
  glass.unlit = true;
  glass.alpha_mode = AlphaMode::kBlend;
  glass.base_color.a = 0.4F;
  Instance instance;
  instance.model = test::one_primitive_model(test::box_primitive(glm::vec3(0.3F)), glass);
  instance.world_from_model = glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 2));
  scene.instances.push_back(instance);
  const Layer layer = renderer.draw_layer(scene, camera);
  EXPECT_EQ(at(layer.rgba, 320, 240, 3), 102);
  EXPECT_EQ(at(layer.rgba, 320, 240, 0), 102);
}

/// Surroundings of one radiance must come back from anything white, whatever its roughness.
TEST(Layer, WhiteFurnace) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  for (const float metallic : {0.0F, 1.0F}) {
    for (const float roughness : {0.1F, 0.4F, 0.7F, 1.0F}) {
      LayerScene scene;
      Material material = test::matte(glm::vec3(1.0F));
      material.metallic = metallic;
      material.roughness = roughness;
      Instance instance;
      instance.model = test::one_primitive_model(test::sphere_primitive(0.5F), material);
      instance.world_from_model = glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 2));
      scene.instances.push_back(instance);
      scene.light = Light::uniform(glm::vec3(0.5F), no_sun());
      const Layer layer = renderer.draw_layer(scene, camera);
      for (const int offset : {0, 40, 80}) {
        EXPECT_NEAR(at(layer.rgba, 320 + offset, 240, 0), test::encoded(0.5F), 2.0F)
            << metallic << " " << roughness << " " << offset;
      }
    }
  }
}

TEST(Layer, MirroredAndTurnedModelsShowTheirFronts) {
  Renderer renderer(test::renderer_options());
  for (const float fy : {525.0F, -525.0F}) {
    Camera camera;
    camera.fy = fy;
    for (const glm::vec3 scale : {glm::vec3(1, 1, 1), glm::vec3(-1, 1, 1), glm::vec3(1, -1, -1)}) {
      LayerScene scene;
      scene.instances.push_back(box_at({0, 0, 2}, glm::vec3(0.3F)));
      scene.instances[0].world_from_model = glm::scale(scene.instances[0].world_from_model, scale);
      scene.light = Light::uniform(glm::vec3(0.5F), no_sun());
      const Layer layer = renderer.draw_layer(scene, camera);
      EXPECT_NEAR(at(layer.depth, 320, 240), 1.7F, 1e-4F) << fy << " " << scale.x;
    }
  }
}

TEST(Layer, NothingToDrawIsEmpty) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  LayerScene scene;
  scene.catchers.push_back(floor_patch(1.0F));
  Layer layer = renderer.draw_layer(scene, camera);
  EXPECT_EQ(layer.bounds.width, 0);
  scene.instances.push_back(box_at({0, 0, -2}, glm::vec3(0.3F)));  // behind the camera
  layer = renderer.draw_layer(scene, camera);
  EXPECT_EQ(layer.bounds.width, 0);
  EXPECT_EQ(layer.rgba.pixels, std::vector<std::uint8_t>(640 * 480 * 4, 0));
}

TEST(Layer, SameBytesFromOneRendererTwoRenderersAndBothContexts) {
  const LayerScene scene = box_scene();
  const Camera camera = downward_camera();
  Renderer first(test::renderer_options());
  const Layer reference = first.draw_layer(scene, camera);
  Camera other = camera;
  other.width = 320;
  first.draw_layer(scene, other);  // another size in between
  EXPECT_EQ(first.draw_layer(scene, camera).rgba.pixels, reference.rgba.pixels);
  first.forget();
  EXPECT_EQ(first.draw_layer(scene, camera).rgba.pixels, reference.rgba.pixels);
  {
    Renderer second(test::renderer_options());
    const Layer again = second.draw_layer(scene, camera);
    EXPECT_EQ(again.rgba.pixels, reference.rgba.pixels);
    EXPECT_EQ(again.depth.pixels, reference.depth.pixels);
  }
  EXPECT_EQ(first.draw_layer(scene, camera).rgba.pixels, reference.rgba.pixels);
  try {
    Renderer egl(test::renderer_options(ContextKind::kEgl));
    EXPECT_EQ(egl.draw_layer(scene, camera).rgba.pixels, reference.rgba.pixels);
  } catch (const std::runtime_error& error) {
    GTEST_SKIP() << "no EGL here: " << error.what();
  }
}

TEST(Layer, StaleShadowsAreNotReused) {
  Renderer renderer(test::renderer_options());
  const Camera camera = downward_camera();
  LayerScene scene = box_scene();
  renderer.draw_layer(scene, camera);
  scene.instances[0].world_from_model[3][0] = -0.3F;
  const Layer moved = renderer.draw_layer(scene, camera);
  Renderer fresh(test::renderer_options());
  EXPECT_EQ(moved.rgba.pixels, fresh.draw_layer(scene, camera).rgba.pixels);
  scene.light.sun.direction_to_light = glm::normalize(glm::vec3(0.5F, -1.0F, 0.2F));
  EXPECT_EQ(renderer.draw_layer(scene, camera).rgba.pixels,
            fresh.draw_layer(scene, camera).rgba.pixels);
}

TEST(Layer, DeformedModelsMayComeAndGo) {
  Renderer renderer(test::renderer_options());
  Camera camera;
  for (int i = 0; i < 8; ++i) {
    Primitive primitive =
        i % 2 == 0 ? test::box_primitive(glm::vec3(0.3F)) : test::sphere_primitive(0.3F, 24);
    primitive.targets.resize(1);
    primitive.targets[0].positions.assign(primitive.shape.size(), glm::vec3(0, 0, -0.1F));
    auto model = test::one_primitive_model(primitive, test::matte(glm::vec3(0.5F)));
    model->nodes[0].weights = {1.0F};
    LayerScene scene;
    Instance instance;
    instance.model = model;
    instance.world_from_model[3] = glm::vec4(0, 0, 2, 1);
    scene.instances.push_back(instance);
    EXPECT_NEAR(at(renderer.draw_layer(scene, camera).depth, 320, 240), 1.6F, 2e-3F);
  }
}

TEST(RendererStart, SaysWhatIsMissing) {
  RendererOptions options = test::renderer_options();
  options.shader_dir = "/no/such/folder";
  EXPECT_THROW(Renderer{options}, std::runtime_error);
  Renderer renderer(test::renderer_options());
  EXPECT_NE(renderer.description().find("4.5"), std::string::npos);
  Camera camera;
  camera.width = 0;
  EXPECT_THROW(renderer.draw_layer({}, camera), std::invalid_argument);
}

}  // namespace
}  // namespace planecast::render
