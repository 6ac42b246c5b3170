#include "render/gltf/polished.h"

#include <gtest/gtest.h>

#include "render_test_tools.h"

namespace planecast::render {
namespace {

std::shared_ptr<Model> ball(float metallic, float roughness) {
  Material material;
  material.metallic = metallic;
  material.roughness = roughness;
  return test::one_primitive_model(test::sphere_primitive(0.5F, 8), material);
}

TEST(Polished, SmoothMetalAndMirrorsAre) {
  EXPECT_TRUE(is_polished(*ball(1.0F, 0.3F)));
  EXPECT_TRUE(is_polished(*ball(0.0F, 0.1F)));
  EXPECT_FALSE(is_polished(*ball(1.0F, 0.8F)));
  EXPECT_FALSE(is_polished(*ball(0.0F, 0.5F)));
}

/// The left half of the texture is a mirror, but the mesh uses the right one.
TEST(Polished, OnlyTexelsOnTheMeshCount) {
  const auto model = ball(1.0F, 1.0F);
  ImageU8 image(8, 1, 3);
  for (int x = 4; x < 8; ++x) image.pixels[static_cast<std::size_t>(3 * x + 1)] = 200;
  model->images = {image};
  model->textures = {{0}};
  model->materials[0].metallic_roughness_map.texture = 0;
  for (SurfaceVertex& vertex : model->meshes[0].primitives[0].surface) vertex.uv0 = {0.8F, 0.5F};
  EXPECT_FALSE(is_polished(*model));
  for (SurfaceVertex& vertex : model->meshes[0].primitives[0].surface) vertex.uv0 = {0.2F, 0.5F};
  EXPECT_TRUE(is_polished(*model));
}

}  // namespace
}  // namespace planecast::render
