#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>
#include <utility>

#include "render/renderer.h"
#include "render/software/mip_texture.h"
#include "render/software/sample_grid.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

constexpr int kSide = 48;

int covered_samples(const SampleGrid& grid, std::int32_t number) {
  int count = 0;
  for (int y = 0; y < grid.rows(); ++y) {
    for (int x = 0; x < grid.columns(); ++x) {
      for (int s = 0; s < 4; ++s) count += grid.block(x, y).triangle[s] == number ? 1 : 0;
    }
  }
  return count;
}

/// Neighbours leave no gap and share no sample: a fan of slim triangles fills its square exactly.
/// In the larger square triangles are wide enough for the path that looks at many blocks together.
TEST(SampleGrid, TrianglesOfOneSurfaceCoverEachSampleOnce) {
  std::mt19937 random(7);
  for (const auto& [pattern, side] : {std::pair{SampleGrid::Pattern::kFourSamples, 48},
                                      {SampleGrid::Pattern::kPixelCentres, 48},
                                      {SampleGrid::Pattern::kFourSamples, 200},
                                      {SampleGrid::Pattern::kPixelCentres, 400}}) {
    const float end = static_cast<float>(side) - 0.5F;
    std::uniform_real_distribution<float> somewhere(0.2F * end, 0.8F * end);
    for (int round = 0; round < 20; ++round) {
      const glm::vec2 middle(somewhere(random), somewhere(random));
      const int slices = round % 2 == 0 ? 3 : 12;
      std::vector<glm::vec2> rim;
      for (int i = 0; i < 4 * slices; ++i) {
        const float t = static_cast<float>(i % slices) / static_cast<float>(slices);
        const std::array<glm::vec2, 5> corners = {
            glm::vec2(-0.5F), {end, -0.5F}, glm::vec2(end), {-0.5F, end}, glm::vec2(-0.5F)};
        const auto edge = static_cast<std::size_t>(i / slices);
        rim.push_back(glm::mix(corners[edge], corners[edge + 1], t));
      }
      int total = 0;
      SampleGrid grid(pattern);
      for (std::size_t i = 0; i < rim.size(); ++i) {
        const auto at = [](glm::vec2 p) { return snapped(p.x, p.y, 0.5F, 1.0F); };
        grid.begin(side, side);
        grid.draw(at(middle), at(rim[i]), at(rim[(i + 1) % rim.size()]), 1);
        total += covered_samples(grid, 1);
      }
      EXPECT_EQ(total, grid.columns() * grid.rows() * 4);
    }
  }
}

TEST(SampleGrid, TheNearestTriangleWinsWhateverTheOrder) {
  const auto corner = [](float u, float v, float depth) { return snapped(u, v, depth, 1.0F); };
  for (const bool near_first : {false, true}) {
    SampleGrid grid(SampleGrid::Pattern::kFourSamples);
    grid.begin(kSide, kSide);
    const auto near = [&] {
      grid.draw(corner(0, 0, 0.9F), corner(40, 0, 0.9F), corner(0, 40, 0.9F), 1);
    };
    const auto far = [&] {
      grid.draw(corner(0, 0, 0.2F), corner(0, 40, 0.2F), corner(40, 0, 0.2F), 2);
    };
    if (near_first) near();
    far();
    if (!near_first) near();
    EXPECT_EQ(covered_samples(grid, 2), 0);
    EXPECT_NEAR(covered_samples(grid, 1), 4 * 800, 30);
  }
}

TEST(SampleGrid, DepthIsExactAtTheSamples) {
  SampleGrid grid(SampleGrid::Pattern::kPixelCentres);
  grid.begin(kSide, kSide);
  const auto corner = [](float u, float v) {
    return snapped(u, v, 0.1F + 0.01F * u + 0.002F * v, 1.0F);
  };
  grid.draw(corner(2, 3), corner(45, 5), corner(7, 44), 1);
  EXPECT_NEAR(grid.block(2, 20).depth[3], 0.1F + 0.11F + 0.04F, 1e-6F);
}

/// A concave outline with a hole, wound either way.
TEST(SampleGrid, MarksAreEvenOdd) {
  std::vector<glm::vec2> outer = {{4, 4}, {40, 4}, {40, 40}, {22, 20}, {4, 40}};
  const std::vector<glm::vec2> hole = {{10, 8}, {16, 8}, {16, 14}, {10, 14}};
  for (int winding = 0; winding < 2; ++winding) {
    SampleGrid grid(SampleGrid::Pattern::kFourSamples);
    grid.begin(kSide, kSide);
    grid.mark({outer, hole});
    const DepthPlane near(0.0F, 0.0F, 0.5F);
    EXPECT_EQ(grid.take_marks(13, 11, near), 0U) << "in the hole";
    EXPECT_EQ(grid.take_marks(22, 35, near), 0U) << "in the notch";
    EXPECT_EQ(grid.take_marks(22, 10, near), 15U);
    EXPECT_EQ(grid.take_marks(22, 10, near), 0U) << "taken before";
    EXPECT_EQ(grid.take_marks(30, 10, DepthPlane(0.0F, 0.0F, -0.5F)), 0U) << "behind everything";
    std::ranges::reverse(outer);
  }
}

ImageU8 two_by_two() {
  ImageU8 image(2, 2, 1);
  image.pixels = {0, 200, 100, 40};
  return image;
}

TEST(MipTexture, BlendsAndWrapsAsOpenGlDoes) {
  MipTexture::Options options;
  const MipTexture repeated(two_by_two(), options);
  EXPECT_NEAR(repeated.sample({0.5F, 0.25F}, 0.0F)[0], 100.0F / 255.0F, 1e-5F);
  EXPECT_NEAR(repeated.sample({0.0F, 0.25F}, 0.0F)[0], 100.0F / 255.0F, 1e-5F) << "round the edge";
  EXPECT_NEAR(repeated.sample({-3.75F, 7.25F}, 0.0F)[0], 0.0F, 1e-5F);
  EXPECT_NEAR(repeated.sample({0.1F, 0.9F}, 1.0F)[0], 85.0F / 255.0F, 1e-5F) << "the mean of all";
  EXPECT_NEAR(repeated.sample({0.25F, 0.25F}, 0.5F)[0], 42.5F / 255.0F, 1e-5F) << "between levels";
  options.wrap_s = GL_CLAMP_TO_EDGE;
  options.wrap_t = GL_MIRRORED_REPEAT;
  const MipTexture clamped(two_by_two(), options);
  EXPECT_NEAR(clamped.sample({9.0F, 0.25F}, 0.0F)[0], 200.0F / 255.0F, 1e-5F);
  EXPECT_NEAR(clamped.sample({0.25F, -0.75F}, 0.0F)[0], 100.0F / 255.0F, 1e-5F);
  options.mag_filter = GL_NEAREST;
  const MipTexture nearest(two_by_two(), options);
  EXPECT_NEAR(nearest.sample({0.4F, 0.4F}, 0.0F)[0], 0.0F, 1e-6F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_GE(repeated.sample({nan, 1e30F}, nan)[0], 0.0F) << "reads somewhere inside";
}

TEST(MipTexture, ColoursAreBlendedAsLight) {
  ImageU8 image(2, 1, 3);
  image.pixels = {0, 0, 0, 255, 255, 255};
  MipTexture::Options options;
  options.colors = options.decode = true;
  EXPECT_NEAR(MipTexture(image, options).sample({0.5F, 0.5F}, 0.0F)[0], 0.5F, 1e-5F);
  options.decode = false;
  EXPECT_NEAR(MipTexture(image, options).sample({0.5F, 0.5F}, 1.0F)[0], 188.0F / 255.0F, 1e-5F);
}

/// Every size, wrap and place at the borders, also where the coordinate is no ordinary number: the
/// sanitizers watch.
TEST(MipTexture, ReadsNothingBesideItsTexels) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const std::vector<float> places = {0.0F,   1.0F,   -1.0F,    0.999999F, 1.0F - 1e-8F,
                                     -1e-9F, 7.5F,   infinite, nan,       -infinite,
                                     1e30F,  -1e30F, 0.5F};
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {3, 2}, {8, 8}, {5, 1}}) {
    ImageU8 image(width, height, 3);
    std::ranges::fill(image.pixels, std::uint8_t{51});
    for (const GLint wrap : {GL_REPEAT, GL_MIRRORED_REPEAT, GL_CLAMP_TO_EDGE}) {
      for (const GLint filter : {GL_NEAREST, GL_LINEAR, GL_LINEAR_MIPMAP_LINEAR}) {
        MipTexture::Options options;
        options.wrap_s = options.wrap_t = wrap;
        options.min_filter = filter;
        options.mag_filter = filter == GL_NEAREST ? GL_NEAREST : GL_LINEAR;
        const MipTexture texture(image, options);
        for (const float u : places) {
          for (const float v : places) {
            for (const float level : {-1.0F, 0.3F, 2.0F, 40.0F, infinite, nan}) {
              EXPECT_NEAR(texture.sample({u, v}, level).g, 0.2F, 1e-6F);
            }
          }
        }
      }
    }
  }
}

TEST(MipTexture, LogarithmIsClose) {
  for (float x = 1e-3F; x < 1e4F; x *= 1.07F) EXPECT_NEAR(fast_log2(x), std::log2(x), 5e-5F);
}

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
};

LayerScene scene_of(const Variant& variant) {
  Material material;
  material.base_color = {0.8F, 0.6F, 0.5F, 1.0F};
  material.metallic = 0.4F;
  material.roughness = variant.texture_side > 0 ? 1.0F : 0.5F;
  material.emissive = {0.02F, 0.0F, 0.05F};
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
  const LayerScene scene = scene_of(GetParam());
  const Camera camera = slanting_camera();
  RendererOptions options = test::renderer_options();
  options.time_passes = true;
  Renderer quick(options);
  const Layer a = quick.draw_layer(scene, camera);
  EXPECT_TRUE(quick.pass_times_ms().contains("objects by the processor"));
  options.only_opengl = true;
  Renderer reference(options);
  const Layer b = reference.draw_layer(scene, camera);
  EXPECT_FALSE(reference.pass_times_ms().contains("objects by the processor"));
  const Difference difference = difference_of(a, b);
  EXPECT_GT(difference.interior, 5000);
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
                      Variant{"occluded", 0, false, false, false, false, true}),
    [](const auto& given) { return given.param.name; });

TEST(Software, WhatItDoesNotKnowGoesThroughOpenGl) {
  RendererOptions options = test::renderer_options();
  options.time_passes = true;
  Renderer renderer(options);
  const auto by_processor = [&](const LayerScene& scene, const Camera& camera) {
    renderer.draw_layer(scene, camera);
    return renderer.pass_times_ms().contains("objects by the processor");
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
