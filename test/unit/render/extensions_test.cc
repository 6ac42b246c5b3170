#include <gtest/gtest.h>

#include "gltf_test_tools.h"
#include "render/gltf/decode_image.h"
#include "render/gltf/model.h"
#include "render/gltf/uri.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

ImportResult import_own(const std::string& name, const ImportOptions& options = {}) {
  return import_gltf(std::string(PLANECAST_SOURCE_DIR) + "/test/golden/models/" + name + ".gltf",
                     options);
}

TEST(Uri, NamesFilesBelowTheModelOnly) {
  EXPECT_EQ(resolve_uri("/models", "a%20b.bin"), "/models/a b.bin");
  EXPECT_EQ(resolve_uri("/models", "textures/../a.png"), "/models/textures/../a.png");
  for (const char* bad : {"../secret", "a/../../secret", "/etc/passwd", "%2e%2e/secret",
                          "file:///etc/passwd", "http://example.org/a.bin", "", "\\\\host\\a"}) {
    EXPECT_ANY_THROW(resolve_uri("/models", bad)) << bad;
  }
}

TEST(Uri, DataIsDecoded) {
  const auto text = decode_data_uri("data:text/plain;base64,SGVsbG8h");
  ASSERT_TRUE(text.has_value());
  EXPECT_EQ(std::string(text->begin(), text->end()), "Hello!");
  EXPECT_FALSE(decode_data_uri("data:;base64,***").has_value());
  EXPECT_FALSE(decode_data_uri("data:nothing").has_value());
}

TEST(DecodeImage, RefusesSizesBeforeDecoding) {
  // A PNG header that promises 60000 x 60000 pixels and has none.
  std::vector<unsigned char> png = {0x89, 'P',  'N', 'G', 13,  10, 26, 10,   0,    0, 0,
                                    13,   'I',  'H', 'D', 'R', 0,  0,  0xEA, 0x60, 0, 0,
                                    0xEA, 0x60, 8,   2,   0,   0,  0,  0,    0,    0, 0};
  const DecodedImage image = decode_image(png);
  EXPECT_TRUE(image.image.empty());
  EXPECT_FALSE(image.error.empty());
  EXPECT_FALSE(decode_image({1, 2, 3}).error.empty());
  EXPECT_FALSE(decode_image({}).error.empty());
}

TEST(Extensions, LayersOfMaterialsAreRead) {
  const ImportResult result = import_own("layers");
  ASSERT_NE(result.model, nullptr) << result.error;
  EXPECT_TRUE(result.warnings.empty());
  const auto& materials = result.model->materials;
  EXPECT_EQ(materials[0].clearcoat, 1.0F);
  EXPECT_EQ(materials[1].sheen_roughness, 0.4F);
  EXPECT_EQ(materials[2].specular_color, glm::vec3(1.0F, 0.3F, 0.1F));
  EXPECT_EQ(materials[3].ior, 2.4F);
  EXPECT_TRUE(materials[4].see_through());
}

TEST(Extensions, VariantsChooseMaterials) {
  for (const auto& [name, material] :
       std::vector<std::pair<std::string, int>>{{"", 0}, {"red", 1}, {"blue", 2}}) {
    ImportOptions options;
    options.variant = name;
    const ImportResult result = import_own("variants", options);
    ASSERT_NE(result.model, nullptr) << result.error;
    EXPECT_EQ(result.model->meshes[0].primitives[0].material, material);
  }
  ImportOptions options;
  options.variant = "green";
  EXPECT_EQ(import_own("variants", options).error, "has no variant 'green'");
}

TEST(Extensions, InstancesBecomeNodes) {
  const ImportResult result = import_own("instances");
  ASSERT_NE(result.model, nullptr) << result.error;
  EXPECT_EQ(result.model->order.size(), 8U);
  const Bounds bounds = model_bounds(*result.model);
  EXPECT_GT(bounds.max.y, 1.1F);
}

TEST(Extensions, LampsShineWhereTheyStand) {
  const ImportResult result = import_own("lamps");
  ASSERT_NE(result.model, nullptr) << result.error;
  ASSERT_EQ(result.model->lights.size(), 2U);
  // An irradiance of I / d^2 on a facing surface, reflected diffusely: albedo / pi of it.
  Material material = test::matte(glm::vec3(1.0F));
  material.specular = 0.0F;
  Primitive wall = test::box_primitive(glm::vec3(1.0F, 1.0F, 0.1F));
  const auto model = test::one_primitive_model(wall, material);
  model->nodes.emplace_back();
  model->nodes[1].rest.translation = {0.0F, 0.0F, -0.6F};
  model->order = {0, 1};
  ModelLight light;
  light.node = 1;
  light.intensity = glm::vec3(0.4F);
  model->lights.push_back(light);
  LayerScene scene;
  Instance instance;
  instance.model = model;
  instance.world_from_model[3] = glm::vec4(0, 0, 2, 1);
  scene.instances.push_back(instance);
  scene.light = Light::uniform(glm::vec3(0.0F), test::no_sun());
  Renderer renderer(test::renderer_options());
  Camera camera;
  const Layer layer = renderer.draw_layer(scene, camera);
  const float expected = 0.4F / (0.5F * 0.5F) / 3.14159265F;
  EXPECT_NEAR(test::at(layer.rgba, 320, 240), test::encoded(expected), 1.5F);
}

TEST(Import, PointsAndLinesAreKept) {
  const ImportResult result = import_own("primitive_modes");
  ASSERT_NE(result.model, nullptr) << result.error;
  EXPECT_TRUE(result.warnings.empty());
  ASSERT_EQ(result.model->meshes.size(), 7U);
  const auto primitive = [&](std::size_t mode) -> const Primitive& {
    return result.model->meshes[mode].primitives[0];
  };
  EXPECT_EQ(primitive(0).topology, Topology::kPoints);
  EXPECT_EQ(primitive(1).indices.size(), 8U);   // pairs of lines
  EXPECT_EQ(primitive(2).indices.size(), 16U);  // a loop closes
  EXPECT_EQ(primitive(3).indices.size(), 14U);  // a strip does not
  EXPECT_TRUE(primitive(3).unlit);
  EXPECT_EQ(primitive(4).indices.size(), 9U);
  EXPECT_EQ(primitive(5).indices.size(), 18U);
  EXPECT_EQ(primitive(6).indices.size(), 18U);
}

TEST(ExtensionData, CompressedModelsAreReadWithoutWarning) {
  const auto folder = test::data_folder();
  if (folder.empty()) GTEST_SKIP() << "no recorded data on this machine";
  const auto extensions = folder / "gltf/extensions/gltf-pipeline/specs/data/2.0/extensions";
  for (const auto& path :
       {extensions / "EXT_meshopt_compression/meshopt-fallback/meshopt-fallback.gltf",
        extensions / "EXT_meshopt_compression/meshopt-no-fallback/meshopt-no-fallback.gltf",
        extensions / "EXT_texture_webp/box-textured-embedded/box-textured-embedded.gltf",
        folder / "gltf/malformed/assimp-debian/glTF2/draco/2CylinderEngine.gltf"}) {
    const ImportResult result = import_gltf(path.string());
    ASSERT_NE(result.model, nullptr) << path << ": " << result.error;
    EXPECT_TRUE(result.warnings.empty()) << path << ": " << result.warnings.front();
    const Bounds bounds = model_bounds(*result.model);
    EXPECT_GT(glm::length(bounds.max - bounds.min), 0.1F) << path;
  }
}

}  // namespace
}  // namespace planecast::render
