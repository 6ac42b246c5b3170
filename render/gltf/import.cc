#include "render/gltf/import.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "render/gltf/accessors.h"
#include "render/gltf/materials.h"
#include "render/gltf/model.h"
#include "render/gltf/nodes.h"
#include "render/gltf/primitives.h"

namespace planecast::render {
namespace {

constexpr std::array<std::string_view, 4> kSupportedExtensions = {
    "KHR_texture_transform", "KHR_materials_unlit", "KHR_mesh_quantization",
    "KHR_materials_emissive_strength"};

bool supported(const std::string& extension) {
  return std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), extension) !=
         kSupportedExtensions.end();
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\r' || c == '\t'; }, ' ');
    if (line.find_first_not_of(' ') != std::string::npos) out.push_back(line);
    begin = end + 1;
  }
  return out;
}

/// A picture that cannot be decoded leaves its texture out; the model is still worth drawing.
bool load_image(tinygltf::Image* image, const int index, std::string*, std::string* warning,
                int width, int height, const unsigned char* bytes, int size, void*) {
  std::string error;
  const bool ok = size > 0 && tinygltf::LoadImageData(image, index, &error, warning, width, height,
                                                      bytes, size, nullptr);
  if (!ok) {
    image->image.clear();
    image->width = image->height = -1;
    *warning += "image " + std::to_string(index) + " cannot be decoded, it is left out\n";
  }
  return true;
}

/// The JSON library's messages begin with its own name in brackets.
std::string reason(const std::string& message) {
  const auto all = lines(message);
  if (all.empty()) return "is not a glTF file";
  const std::string& first = all.front();
  if (!first.starts_with("[json.exception")) return first;
  const std::size_t bracket = first.find("] ");
  return "is not valid JSON: " + (bracket == std::string::npos ? first : first.substr(bracket + 2));
}

bool is_binary(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ImportError("cannot be opened");
  std::array<char, 4> magic{};
  in.read(magic.data(), magic.size());
  if (in.gcount() < 4) throw ImportError("is not a glTF file");
  return std::string_view(magic.data(), 4) == "glTF";
}

tinygltf::Model parse(const std::string& path, std::vector<std::string>& warnings) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(&load_image, nullptr);
  tinygltf::Model file;
  std::string error;
  std::string warning;
  const bool ok = is_binary(path) ? loader.LoadBinaryFromFile(&file, &error, &warning, path)
                                  : loader.LoadASCIIFromFile(&file, &error, &warning, path);
  for (const std::string& line : lines(warning)) warnings.push_back(line);
  if (!ok) throw ImportError(reason(error));
  return file;
}

void check_extensions(const tinygltf::Model& file, std::vector<std::string>& warnings) {
  for (const std::string& extension : file.extensionsRequired) {
    if (!supported(extension)) throw ImportError("needs the unsupported extension " + extension);
  }
  std::string ignored;
  for (const std::string& extension : file.extensionsUsed) {
    if (!supported(extension)) ignored += (ignored.empty() ? "" : ", ") + extension;
  }
  if (!ignored.empty()) warnings.push_back("unsupported extensions are ignored: " + ignored);
}

/// Joint numbers beyond their skin would read foreign memory when the mesh is drawn.
void check_joints(const Model& model) {
  for (const Node& node : model.nodes) {
    if (node.mesh < 0 || node.skin < 0) continue;
    const std::size_t joints = model.skins[static_cast<std::size_t>(node.skin)].joints.size();
    for (const Primitive& primitive :
         model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      for (const auto& vertex : primitive.joints) {
        if (*std::max_element(vertex.begin(), vertex.end()) >= joints) {
          throw ImportError("a vertex uses a joint that its skin does not have");
        }
      }
    }
  }
}

std::shared_ptr<const Model> convert(const tinygltf::Model& file,
                                     std::vector<std::string>& warnings) {
  auto model = std::make_shared<Model>();
  import_materials(file, *model, warnings);
  for (const auto& from : file.meshes) {
    Mesh mesh;
    mesh.weights.assign(from.weights.begin(), from.weights.end());
    for (const auto& primitive : from.primitives) {
      if (auto converted = import_primitive(file, primitive, model->materials, warnings)) {
        mesh.primitives.push_back(std::move(*converted));
      }
    }
    model->meshes.push_back(std::move(mesh));
  }
  import_nodes(file, *model);
  import_skins(file, *model);
  import_animations(file, *model);
  check_joints(*model);
  return model;
}

bool draws_nothing(const Model& model) {
  return std::none_of(model.order.begin(), model.order.end(), [&model](int index) {
    const int mesh = model.nodes[static_cast<std::size_t>(index)].mesh;
    return mesh >= 0 && !model.meshes[static_cast<std::size_t>(mesh)].primitives.empty();
  });
}

void keep_first_of_each(std::vector<std::string>& warnings) {
  std::vector<std::string> unique;
  for (std::string& warning : warnings) {
    if (std::find(unique.begin(), unique.end(), warning) == unique.end()) {
      unique.push_back(std::move(warning));
    }
  }
  warnings = std::move(unique);
}

}  // namespace

ImportResult import_gltf(const std::string& path) {
  ImportResult result;
  try {
    const tinygltf::Model file = parse(path, result.warnings);
    check_extensions(file, result.warnings);
    result.model = convert(file, result.warnings);
    if (draws_nothing(*result.model)) result.warnings.emplace_back("it has nothing to draw");
  } catch (const std::exception& error) {
    // Besides our own, the parser's and std::bad_alloc for sizes that lie.
    result.error = reason(error.what());
  }
  keep_first_of_each(result.warnings);
  return result;
}

}  // namespace planecast::render
