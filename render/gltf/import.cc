#include "render/gltf/import.h"

#include <tiny_gltf.h>

#include <algorithm>

#include "render/gltf/accessors.h"
#include "render/gltf/decode_image.h"
#include "render/gltf/document.h"
#include "render/gltf/materials.h"
#include "render/gltf/model.h"
#include "render/gltf/nodes.h"
#include "render/gltf/primitives.h"

namespace planecast::render {
namespace {

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

/// The JSON library's messages begin with its own name in brackets.
std::string reason(const std::string& message) {
  const auto all = lines(message);
  if (all.empty()) return "is not a glTF file";
  const std::string& first = all.front();
  if (!first.starts_with("[json.exception")) return first;
  const std::size_t bracket = first.find("] ");
  return "is not valid JSON: " + (bracket == std::string::npos ? first : first.substr(bracket + 2));
}

/// The parser sees neither buffers nor images: they are loaded already, and it opens no files.
tinygltf::Model parse(GltfDocument& document, std::vector<std::string>& warnings) {
  document.json.erase("buffers");
  document.json.erase("images");
  const std::string text =
      document.json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  tinygltf::TinyGLTF loader;
  tinygltf::Model file;
  std::string error;
  std::string warning;
  const bool ok = loader.LoadASCIIFromString(&file, &error, &warning, text.data(),
                                             static_cast<unsigned>(text.size()), "");
  for (const std::string& line : lines(warning)) warnings.push_back(line);
  if (!ok) throw ImportError(reason(error));
  for (Bytes& bytes : document.buffers) {
    file.buffers.emplace_back();
    file.buffers.back().data = std::move(bytes);
  }
  return file;
}

/// What meshes take in memory does not follow from the file's size: accessors may be used again and
/// again, and those without a buffer view are zeros that cost nothing.
void check_amount(const tinygltf::Model& file) {
  constexpr std::size_t kMostElements = std::size_t{1} << 26U;
  std::size_t total = 0;
  const auto add = [&](int accessor) {
    if (accessor < 0 || static_cast<std::size_t>(accessor) >= file.accessors.size()) return;
    const std::size_t count = file.accessors[static_cast<std::size_t>(accessor)].count;
    if (count > kMostElements - total) throw ImportError("its meshes have too many vertices");
    total += count;
  };
  for (const auto& mesh : file.meshes) {
    for (const auto& primitive : mesh.primitives) {
      add(primitive.indices);
      for (const auto& [name, accessor] : primitive.attributes) add(accessor);
      for (const auto& target : primitive.targets) {
        for (const auto& [name, accessor] : target) add(accessor);
      }
    }
  }
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

void import_images(const GltfDocument& document, Model& model, std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    DecodedImage decoded = decode_image(document.images[i]);
    // A picture that cannot be decoded leaves its texture out; the model is still worth drawing.
    if (!decoded.error.empty() && !document.images[i].empty()) {
      warnings.push_back("image " + std::to_string(i) + " " + decoded.error + ", it is left out");
    }
    model.images.push_back(std::move(decoded.image));
  }
}

std::shared_ptr<const Model> convert(const GltfDocument& document, const tinygltf::Model& file,
                                     const ImportOptions& options,
                                     std::vector<std::string>& warnings) {
  check_amount(file);
  auto model = std::make_shared<Model>();
  import_images(document, *model, warnings);
  import_materials(file, *model, warnings);
  const int variant = find_variant(file, options.variant, *model);
  for (const auto& from : file.meshes) {
    Mesh mesh;
    mesh.weights.assign(from.weights.begin(), from.weights.end());
    for (const auto& primitive : from.primitives) {
      if (auto converted = import_primitive(file, primitive, model->materials, variant, warnings)) {
        mesh.primitives.push_back(std::move(*converted));
      }
    }
    model->meshes.push_back(std::move(mesh));
  }
  import_nodes(file, options.scene, *model);
  import_skins(file, *model);
  import_animations(file, *model);
  import_cameras_and_lights(file, *model);
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

ImportResult import_gltf(const std::string& path, const ImportOptions& options) {
  ImportResult result;
  try {
    GltfDocument document = read_document(path, result.warnings);
    const tinygltf::Model file = parse(document, result.warnings);
    result.model = convert(document, file, options, result.warnings);
    if (draws_nothing(*result.model)) result.warnings.emplace_back("it has nothing to draw");
  } catch (const std::exception& error) {
    // Besides our own, the parser's and std::bad_alloc for sizes that lie.
    result.error = reason(error.what());
  }
  keep_first_of_each(result.warnings);
  return result;
}

}  // namespace planecast::render
