#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/environment.h"
#include "render/renderer.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

enum class Paint { kColors, kNormals, kNumbers };

/// Smooth, and the same at opposite borders. Numbers are never so smooth that the sun glints:
/// OpenGL filters normals to eight bits, which shows there.
ImageU8 painted(int side, int channels, Paint paint) {
  ImageU8 image(side, side, channels);
  const auto wave = [side](int at, float texels) {
    const float turns = std::round(static_cast<float>(side) / texels);
    return std::sin(6.2831853F * turns * static_cast<float>(at) / static_cast<float>(side));
  };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const float a = wave(x, 57.0F);
      const float b = wave(y, 90.0F);
      glm::vec3 value(0.5F + 0.4F * a * b, 0.5F + 0.3F * a, 0.5F - 0.3F * b);
      if (paint == Paint::kNormals) {
        value = 0.5F * glm::normalize(glm::vec3(0.4F * a, 0.4F * b, 1.0F)) + 0.5F;
      } else if (paint == Paint::kNumbers) {
        value.g = 0.75F + 0.15F * a;
      }
      for (int c = 0; c < channels; ++c) {
        image.pixels[static_cast<std::size_t>((y * side + x) * channels + c)] =
            c == 3 ? 255 : static_cast<std::uint8_t>(255.0F * value[c]);
      }
    }
  }
  return image;
}

struct Variant {
  std::string name;
  int texture_side = 0;  ///< 0: none
  bool double_sided = false;
  bool unlit = false;
  bool vertex_colors = false;
  bool mirrored = false;
  bool occluded = false;
  bool animated = false;  ///< the object swings, and its mesh swells
  bool seen_by_depth = false;
  bool reflecting = false;  ///< a smooth metal under an environment
};

/// The ball turns about its node, leans and swells at its equator.
void animate(Model& model) {
  Primitive& ball = model.meshes[0].primitives[0];
  MorphTarget swollen;
  for (const ShapeVertex& vertex : ball.shape) {
    const glm::vec3 n = glm::normalize(vertex.position);
    swollen.positions.push_back(0.3F * (1.0F - n.y * n.y) * vertex.position);
    swollen.normals.emplace_back(0.0F);
  }
  ball.targets = {swollen};
  Animation swing;
  swing.duration_s = 1.0F;
  const float half = std::sqrt(0.5F);
  swing.channels = {{0,
                     ChannelPath::kRotation,
                     Interpolation::kLinear,
                     {0.0F, 1.0F},
                     {0, 0, 0, 1, half, 0, 0, half},
                     4},
                    {0, ChannelPath::kWeights, Interpolation::kLinear, {0.0F, 1.0F}, {0, 1}, 1}};
  model.animations = {swing};
}

/// A sky that brightens upwards, with a broad lamp on one side.
std::shared_ptr<const Environment> surroundings() {
  ImageF map(64, 32, 3);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const float up = 1.0F - static_cast<float>(y) / static_cast<float>(map.height);
      const float lamp = 0.5F + 0.5F * std::sin(6.2831853F * static_cast<float>(x) / 64.0F);
      float* pixel = &map.pixels[static_cast<std::size_t>(3 * (y * map.width + x))];
      pixel[0] = 0.2F + 0.6F * up;
      pixel[1] = 0.2F + 0.4F * lamp;
      pixel[2] = 0.5F;
    }
  }
  return std::make_shared<Environment>(map);
}

/// A depth image of the camera: a slanting wall in front of the right half, its edge softened, a
/// part of the object's own depth, and nothing known in the upper rows.
ImageF room_depth(int width, int height) {
  ImageF depth(width, height, 1);
  for (int v = height / 3; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const float wall = 0.6F + 0.0025F * static_cast<float>(v - height / 2);
      const float away = 3.0F;
      depth.pixels[static_cast<std::size_t>(v * width + u)] = u > width / 2 ? wall : away;
    }
  }
  return depth;
}

LayerScene scene_of(const Variant& variant) {
  Material material;
  material.base_color = {0.8F, 0.6F, 0.5F, 1.0F};
  material.metallic = 0.4F;
  material.roughness = variant.texture_side > 0 ? 1.0F : 0.5F;
  material.emissive = {0.02F, 0.0F, 0.05F};
  if (variant.reflecting) {
    material.metallic = 1.0F;
    material.roughness = 0.2F;
  }
  material.double_sided = variant.double_sided;
  material.unlit = variant.unlit;
  constexpr int kRings = 40;
  Primitive sphere = test::sphere_primitive(0.15F, kRings);
  for (std::size_t i = 0; i < sphere.shape.size(); ++i) {
    const glm::vec3 n = sphere.shape[i].normal;
    const glm::vec3 along(-n.z, 0.0F, n.x);
    if (glm::length(along) > 1e-3F)
      sphere.shape[i].tangent = glm::vec4(glm::normalize(along), -1.0F);
    const auto column = static_cast<float>(i % (2 * kRings + 1));
    const auto row = static_cast<float>(i / (2 * kRings + 1));
    sphere.surface[i].uv0 = glm::vec2(1.5F * column, 3.0F * row) / static_cast<float>(kRings);
    sphere.surface[i].uv1 = 3.0F * sphere.surface[i].uv0;
    if (variant.vertex_colors) sphere.surface[i].color = {0.5F + 0.5F * n.x, 1.0F, 0.5F, 1.0F};
  }
  // Open at the top, so that the inside shows.
  if (variant.double_sided) {
    sphere.indices.resize(sphere.indices.size() - 6 * 80 * 12);
  }
  if (variant.texture_side > 0) {
    material.base_color_map.texture = 0;
    material.normal_map.texture = 1;
    material.metallic_roughness_map.texture = 2;
    material.occlusion_map.texture = 2;
    material.occlusion_map.uv_set = 1;
    material.base_color_map.transform = glm::mat3(2, 0.3F, 0, -0.3F, 2, 0, 0.1F, 0.7F, 1);
  }
  auto model = test::one_primitive_model(sphere, material);
  if (variant.texture_side > 0) {
    auto changed = std::make_shared<Model>(*model);
    changed->images = {painted(variant.texture_side, 4, Paint::kColors),
                       painted(256, 3, Paint::kNormals), painted(128, 3, Paint::kNumbers)};
    for (int i = 0; i < 3; ++i) changed->textures.push_back({i});
    model = changed;
  }
  LayerScene scene;
  Instance instance;
  if (variant.animated) {
    auto changed = std::make_shared<Model>(*model);
    animate(*changed);
    model = changed;
    instance.animation = 0;
    instance.animation_time_s = 0.4F;
  }
  instance.model = model;
  // World: y down, as in the renderer's camera; the floor is y = 0.
  instance.world_from_model = glm::translate(glm::mat4(1.0F), glm::vec3(0, -0.16F, 0));
  if (variant.mirrored)
    instance.world_from_model = glm::scale(instance.world_from_model, glm::vec3(-1, 1, 1));
  scene.instances = {instance};
  PlanePatch floor;
  floor.normal = {0, -1, 0};
  floor.outer = {{-0.6F, 0, -0.6F}, {0.6F, 0, -0.6F}, {0.6F, 0, 0.6F}, {-0.6F, 0, 0.6F}};
  scene.catchers = {floor};
  if (variant.occluded) {
    PlanePatch wall;
    wall.normal = {0, 0, -1};
    wall.outer = {{0.02F, -1, -0.3F}, {0.02F, 1, -0.3F}, {3, 1, -0.3F}, {3, -1, -0.3F}};
    wall.holes = {{{0.05F, -0.2F, -0.3F}, {0.1F, -0.2F, -0.3F}, {0.1F, -0.1F, -0.3F}}};
    scene.occluders = {wall, floor};
  }
  scene.light = Light::uniform(glm::vec3(0.4F), Sun{});
  scene.light.ambient_sh[1] = glm::vec3(-0.2F, -0.25F, -0.3F);
  scene.light.ambient_sh[6] = glm::vec3(0.05F);
  scene.light.sun.direction_to_light = glm::normalize(glm::vec3(0.4F, -1.0F, -0.5F));
  scene.light.sun.radiance = glm::vec3(0.9F, 0.8F, 0.7F);
  if (variant.reflecting) {
    scene.light.environment = surroundings();
    scene.light.environment_from_world = glm::mat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
    scene.light.environment_gain = 0.8F;
  }
  return scene;
}

Camera slanting_camera() {
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 300.0F;
  camera.cx = 159.5F;
  camera.cy = 119.5F;
  glm::mat4 m = glm::translate(glm::mat4(1.0F), glm::vec3(0.0F, 0.1F, 0.8F));
  m = glm::rotate(m, glm::radians(25.0F), glm::vec3(1, 0, 0));
  camera.camera_from_world = m;
  return camera;
}

struct Difference {
  int interior = 0;         ///< pixels
  int interior_beyond = 0;  ///< of them, those that differ by more than two levels
  int largest = 0;          ///< in the interior
  glm::ivec2 where{};       ///< pixel of the largest
  double edge_mean = 0.0;   ///< levels, over the other pixels that either shows
  double depth_beyond = 0.0;
};

/// Whether a pixel and its neighbours show one surface whole, or the ground with nothing between
/// them: no outline, fold or border of a shadow's area.
bool is_interior(const Layer& layer, int u, int v) {
  const float depth = test::at(layer.depth, u, v);
  const bool ground = depth == 0.0F;
  for (int y = v - 1; y <= v + 1; ++y) {
    for (int x = u - 1; x <= u + 1; ++x) {
      const float other = test::at(layer.depth, x, y);
      const int alpha = test::at(layer.rgba, x, y, 3);
      if (ground != (other == 0.0F) || (ground ? alpha == 0 : alpha != 255)) return false;
      constexpr float kFold = 0.02F;
      if (std::abs(other - depth) > kFold * depth) return false;
    }
  }
  return true;
}

Difference difference_of(const Layer& a, const Layer& b) {
  Difference result;
  int edges = 0;
  for (int v = 1; v + 1 < a.rgba.height; ++v) {
    for (int u = 1; u + 1 < a.rgba.width; ++u) {
      if (test::at(a.rgba, u, v, 3) == 0 && test::at(b.rgba, u, v, 3) == 0) continue;
      int largest = 0;
      for (int c = 0; c < 4; ++c) {
        largest =
            std::max(largest, std::abs(test::at(a.rgba, u, v, c) - test::at(b.rgba, u, v, c)));
      }
      result.depth_beyond +=
          std::abs(test::at(a.depth, u, v) - test::at(b.depth, u, v)) > 1e-3F ? 1.0 : 0.0;
      if (is_interior(a, u, v) && is_interior(b, u, v)) {
        ++result.interior;
        result.interior_beyond += largest > 2 ? 1 : 0;
        if (largest > result.largest) result.where = {u, v};
        result.largest = std::max(result.largest, largest);
      } else {
        ++edges;
        result.edge_mean += largest;
      }
    }
  }
  result.depth_beyond /= std::max(result.interior + edges, 1);
  result.edge_mean /= std::max(edges, 1);
  return result;
}

class TwoPaths : public ::testing::TestWithParam<Variant> {};

/// Two implementations of one picture: the same within two levels, but where an edge crosses the
/// pixel, whose samples may round to either side.
TEST_P(TwoPaths, TheProcessorDrawsWhatOpenGlDraws) {
  LayerScene scene = scene_of(GetParam());
  const Camera camera = slanting_camera();
  const ImageF depth = room_depth(camera.width, camera.height);
  if (GetParam().seen_by_depth) scene.occluder_depth = &depth;
  RendererOptions options = test::renderer_options();
  Renderer quick(options);
  const Layer a = quick.draw_layer(scene, camera);
  EXPECT_TRUE(a.by_processor);
  options.only_opengl = true;
  Renderer reference(options);
  const Layer b = reference.draw_layer(scene, camera);
  EXPECT_FALSE(b.by_processor);
  const Difference difference = difference_of(a, b);
  EXPECT_GT(difference.interior, GetParam().seen_by_depth ? 2500 : 5000);
  EXPECT_LE(difference.interior_beyond, difference.interior / 1000);
  EXPECT_LE(difference.largest, 8)
      << "in pixel (" << difference.where.x << ", " << difference.where.y << ")";
  EXPECT_LT(difference.edge_mean, 1.0);
  EXPECT_LT(difference.depth_beyond, 0.002);
}

INSTANTIATE_TEST_SUITE_P(
    Materials, TwoPaths,
    ::testing::Values(Variant{"plain"}, Variant{"large_textures", 512},
                      Variant{"small_textures", 64}, Variant{"open_shell", 0, true},
                      Variant{"unlit", 512, false, true},
                      Variant{"vertex_colors", 0, false, false, true},
                      Variant{"mirrored", 512, false, false, false, true},
                      Variant{"occluded", 0, false, false, false, false, true},
                      Variant{.name = "animated", .texture_side = 512, .animated = true},
                      Variant{.name = "animated_behind_planes", .occluded = true, .animated = true},
                      Variant{.name = "seen_by_depth", .texture_side = 512, .seen_by_depth = true},
                      Variant{.name = "reflecting", .reflecting = true},
                      Variant{.name = "animated_seen_by_depth",
                              .occluded = true,
                              .animated = true,
                              .seen_by_depth = true}),
    [](const auto& given) { return given.param.name; });

TEST(Software, WhatItDoesNotKnowGoesThroughOpenGl) {
  Renderer renderer(test::renderer_options());
  const auto by_processor = [&](const LayerScene& scene, const Camera& camera) {
    return renderer.draw_layer(scene, camera).by_processor;
  };
  const Camera camera = slanting_camera();
  EXPECT_TRUE(by_processor(scene_of({"plain"}), camera));
  const auto with_material = [&](const auto& change) {
    LayerScene scene = scene_of({"plain"});
    auto model = std::make_shared<Model>(*scene.instances[0].model);
    change(model->materials[0]);
    scene.instances[0].model = model;
    return scene;
  };
  EXPECT_FALSE(
      by_processor(with_material([](Material& m) { m.alpha_mode = AlphaMode::kBlend; }), camera));
  EXPECT_FALSE(by_processor(with_material([](Material& m) { m.clearcoat = 1.0F; }), camera));
  EXPECT_FALSE(by_processor(with_material([](Material& m) { m.ior = 1.2F; }), camera));
  Camera inside = camera;
  inside.camera_from_world = glm::translate(glm::mat4(1.0F), glm::vec3(0.0F, 0.16F, 0.05F));
  EXPECT_FALSE(by_processor(scene_of({"plain"}), inside)) << "the camera is within the object";
}

}  // namespace
}  // namespace planecast::render
