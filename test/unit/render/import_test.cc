#include <gtest/gtest.h>

#include "gltf_test_tools.h"
#include "render/gltf/model.h"
#include "render/gltf/tangents.h"
#include "render_test_tools.h"

namespace planecast::render {
namespace {

using test::import_text;
using test::with;

/// One triangle with indices; 36 bytes of positions, 6 of indices, 2 of padding.
std::string triangle_file() {
  test::BufferBytes bytes;
  bytes.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}).add<std::uint16_t>({0, 1, 2, 0});
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, "translation": [0, 0, 5]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{"byteLength": 44, "uri": ")" +
         bytes.data_uri() + R"("}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36},
                    {"buffer": 0, "byteOffset": 36, "byteLength": 8}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]})";
}

TEST(Import, ReadsATriangleAndGivesItAFlatNormal) {
  const ImportResult result = import_text(triangle_file());
  ASSERT_NE(result.model, nullptr) << result.error;
  EXPECT_TRUE(result.warnings.empty());
  const Primitive& primitive = result.model->meshes[0].primitives[0];
  ASSERT_EQ(primitive.shape.size(), 3U);
  for (const ShapeVertex& vertex : primitive.shape) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
  const Bounds bounds = model_bounds(*result.model);
  EXPECT_EQ(bounds.min, glm::vec3(0, 0, 5));
  EXPECT_EQ(bounds.max, glm::vec3(1, 1, 5));
}

TEST(Import, StripsAndFansKeepTheWinding) {
  for (const int mode : {5, 6}) {
    test::BufferBytes bytes;
    if (mode == 5) {
      bytes.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    } else {
      bytes.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    }
    const ImportResult result = import_text(
        R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": )" +
        std::to_string(mode) + R"(}]}], "buffers": [{"byteLength": 48, "uri": ")" +
        bytes.data_uri() + R"("}], "bufferViews": [{"buffer": 0, "byteLength": 48}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}]})");
    ASSERT_NE(result.model, nullptr) << result.error;
    const Primitive& primitive = result.model->meshes[0].primitives[0];
    ASSERT_EQ(primitive.indices.size(), 6U);
    for (const ShapeVertex& vertex : primitive.shape) EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
  }
}

TEST(Import, ReadsNormalisedIntegersInterleavedAndSparse) {
  test::BufferBytes bytes;
  // Three vertices of 16 bytes: position as floats, colour as four bytes.
  for (const float x : {0.0F, 1.0F, 2.0F}) {
    bytes.add<float>({x, 0, 0}).add<std::uint8_t>({255, 51, 0, 255});
  }
  bytes.add<std::uint8_t>({2, 0, 0, 0}).add<float>({0, 3, 0});
  const ImportResult result = import_text(
      R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}}]}],
      "buffers": [{"byteLength": 64, "uri": ")" +
      bytes.data_uri() + R"("}],
      "bufferViews": [{"buffer": 0, "byteLength": 48, "byteStride": 16},
                      {"buffer": 0, "byteOffset": 48, "byteLength": 16}],
      "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
         "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5121},
                    "values": {"bufferView": 1, "byteOffset": 4}}},
        {"bufferView": 0, "byteOffset": 12, "componentType": 5121, "normalized": true, "count": 3,
         "type": "VEC4"}]})");
  ASSERT_NE(result.model, nullptr) << result.error;
  const Primitive& primitive = result.model->meshes[0].primitives[0];
  EXPECT_EQ(primitive.shape[1].position, glm::vec3(1, 0, 0));
  EXPECT_EQ(primitive.shape[2].position, glm::vec3(0, 3, 0));
  EXPECT_NEAR(primitive.surface[0].color.g, 0.2F, 1e-6F);
}

TEST(Import, RefusesWhatContradictsItself) {
  const std::string good = triangle_file();
  const std::vector<std::pair<std::string, std::string>> damages = {
      {"\"POSITION\": 0", "\"POSITION\": 9"},
      {"\"indices\": 1", "\"indices\": 0"},
      {"\"bufferView\": 0, \"componentType\"", "\"bufferView\": 7, \"componentType\""},
      {"\"count\": 3, \"type\": \"VEC3\"", "\"count\": 300, \"type\": \"VEC3\""},
      {"\"count\": 3, \"type\": \"VEC3\"", "\"count\": 3, \"type\": \"VEC2\""},
      {"\"count\": 3, \"type\": \"VEC3\"",
       "\"byteOffset\": 4000000000, \"count\": 3, \"type\": \"VEC3\""},
      {"\"componentType\": 5126", "\"componentType\": 17"},
      {"\"byteLength\": 36", "\"byteLength\": 3600"},
      {"\"byteLength\": 44", "\"byteLength\": 4400000000000"},
      {"\"buffer\": 0, \"byteOffset\": 36", "\"buffer\": 3, \"byteOffset\": 36"},
      {"\"mesh\": 0", "\"mesh\": 5"},
      {"\"mesh\": 0", "\"mesh\": 0, \"skin\": 2"},
      {"\"mesh\": 0", "\"mesh\": 0, \"children\": [0]"},
      {"\"mesh\": 0", "\"mesh\": 0, \"children\": [4]"},
      {"\"nodes\": [0]", "\"nodes\": [8]"},
      {"\"scene\": 0", "\"scene\": 8"},
      {"\"indices\": 1", "\"indices\": 1, \"material\": 1"},
      {"\"asset\"", "\"extensionsRequired\": [\"KHR_no_such\"], \"asset\""},
      {"{\"asset\"", "{{\"asset\""},
      {"[0, 0, 5]", "[0, 0, \"five\"]"},
  };
  for (const auto& [from, to] : damages) {
    const ImportResult result = import_text(with(good, from, to));
    if (result.model != nullptr) continue;  // what the parser repairs may be drawn
    EXPECT_FALSE(result.error.empty()) << to;
    EXPECT_EQ(result.error.find('\n'), std::string::npos) << to;
  }
  EXPECT_EQ(import_text(with(good, "\"indices\": 1", "\"indices\": 0")).model, nullptr);
  EXPECT_EQ(import_text(with(good, "\"mesh\": 0", "\"mesh\": 0, \"children\": [0]")).model,
            nullptr);
  EXPECT_EQ(import_gltf("/no/such/file.glb").error, "cannot be opened");
}

TEST(Import, CutFilesAreRefused) {
  const std::string good = triangle_file();
  for (std::size_t length = 0; length < good.size(); length += 37) {
    const ImportResult result = import_text(good.substr(0, length));
    EXPECT_EQ(result.model, nullptr) << length;
    EXPECT_FALSE(result.error.empty()) << length;
  }
}

TEST(Import, TextureTransformMovesThenTurnsThenScales) {
  const ImportResult result = import_text(with(
      triangle_file(), "\"asset\"",
      R"("images": [{"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4//8/AAX+Av4N70a4AAAAAElFTkSuQmCC"}],
         "textures": [{"source": 0}],
         "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions":
           {"KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 1.5707963, "scale": [2, 3],
                                      "texCoord": 1}}}}}],
         "extensionsUsed": ["KHR_texture_transform", "VENDOR_one", "VENDOR_two"], "asset")"));
  ASSERT_NE(result.model, nullptr) << result.error;
  const TextureSlot& slot = result.model->materials[0].base_color_map;
  EXPECT_EQ(slot.texture, 0);
  EXPECT_EQ(slot.uv_set, 1);
  const glm::vec3 moved = slot.transform * glm::vec3(1.0F, 0.0F, 1.0F);
  EXPECT_NEAR(moved.x, 0.5F, 1e-5F);
  EXPECT_NEAR(moved.y, 0.25F - 2.0F, 1e-5F);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_EQ(result.warnings[0], "unsupported extensions are ignored: VENDOR_one, VENDOR_two");
}

TEST(Tangents, PointAlongUAndSplitWhereTheTextureIsMirrored) {
  // Two triangles sharing an edge, u running away from it on both sides: mirrored.
  Primitive primitive;
  const std::vector<glm::vec3> corners = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}};
  const std::vector<glm::vec2> uvs = {{0, 1}, {0, 0}, {1, 1}, {1, 1}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    primitive.shape.push_back({corners[i], {0, 0, 1}, {}});
    primitive.surface.push_back({uvs[i], {}, glm::vec4(1.0F)});
  }
  primitive.indices = {0, 2, 1, 0, 1, 3};
  add_tangents(primitive, 0);
  EXPECT_EQ(primitive.shape.size(), 6U);
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const ShapeVertex& vertex = primitive.shape[primitive.indices[3 * t + k]];
      const float right = t == 0 ? 1.0F : -1.0F;
      EXPECT_NEAR(vertex.tangent.x, right, 1e-6F);
      EXPECT_EQ(vertex.tangent.w, right);
      // The bitangent is up, against v, on both sides.
      const glm::vec3 up = glm::cross(vertex.normal, glm::vec3(vertex.tangent)) * vertex.tangent.w;
      EXPECT_NEAR(up.y, 1.0F, 1e-6F);
    }
  }
}

std::vector<std::filesystem::path> gltf_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (extension == ".gltf" || extension == ".glb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(ImportData, EveryCoreModelIsReadAndDrawn) {
  const auto folder = test::data_folder();
  if (folder.empty()) GTEST_SKIP() << "no recorded data on this machine";
  Renderer renderer(test::renderer_options());
  Camera camera;
  camera.width = camera.height = 96;
  camera.fx = camera.fy = 96.0F;
  camera.cx = camera.cy = 47.5F;
  for (const auto& path : gltf_files(folder / "gltf" / "core")) {
    const ImportResult result = import_gltf(path.string());
    ASSERT_NE(result.model, nullptr) << path << ": " << result.error;
    const Bounds bounds = model_bounds(*result.model);
    const glm::vec3 size = bounds.max - bounds.min;
    const float longest = std::max(size.x, std::max(size.y, size.z));
    ASSERT_GT(longest, 0.0F) << path;
    LayerScene scene;
    Instance instance;
    instance.model = result.model;
    instance.animation = 0;
    instance.animation_time_s = 0.3F;
    // Turned so that flat models show their front: y up and z towards the camera.
    glm::mat4 m(1.0F);
    m[1][1] = m[2][2] = -1.0F;
    m *= 1.0F / longest;
    m[3] = glm::vec4(glm::mat3(m) * (-0.5F * (bounds.min + bounds.max)) + glm::vec3(0, 0, 2), 1.0F);
    m[3][3] = 1.0F;
    // A plane lying in y is seen from above.
    if (size.y < 0.01F * longest) {
      const glm::mat4 up(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0),
                         glm::vec4(0, 0, 0, 1));
      m = glm::mat4(glm::mat3(m)) * up;
      m[3] = glm::vec4(0, 0, 2, 1);
    }
    instance.world_from_model = m;
    scene.instances.push_back(instance);
    scene.light = Light::uniform(glm::vec3(0.4F), Sun{});
    const Layer layer = renderer.draw_layer(scene, camera);
    int covered = 0;
    for (std::size_t i = 3; i < layer.rgba.pixels.size(); i += 4)
      covered += layer.rgba.pixels[i] > 0;
    EXPECT_GT(covered, 20) << path;
  }
}

TEST(ImportData, MalformedFilesNeverCrash) {
  const auto folder = test::data_folder();
  if (folder.empty()) GTEST_SKIP() << "no recorded data on this machine";
  Renderer renderer(test::renderer_options());
  Camera camera;
  camera.width = camera.height = 32;
  int refused = 0;
  for (const char* kind : {"malformed", "extensions"}) {
    for (const auto& path : gltf_files(folder / "gltf" / kind)) {
      const ImportResult result = import_gltf(path.string());
      if (result.model == nullptr) {
        EXPECT_FALSE(result.error.empty()) << path;
        EXPECT_EQ(result.error.find('\n'), std::string::npos) << path;
        ++refused;
        continue;
      }
      LayerScene scene;
      Instance instance;
      instance.model = result.model;
      instance.animation = 0;
      instance.animation_time_s = 0.5F;
      instance.world_from_model[3] = glm::vec4(0, 0, 5, 1);
      scene.instances.push_back(instance);
      renderer.draw_layer(scene, camera);
    }
  }
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace planecast::render
