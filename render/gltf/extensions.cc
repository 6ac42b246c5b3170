#include "render/gltf/extensions.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "render/gltf/accessors.h"

namespace planecast::render {
namespace {

bool supported(const std::string& extension) {
  return std::ranges::binary_search(supported_extensions(), extension);
}

std::vector<std::string> names(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return {};
  if (!found->is_array()) throw ImportError("'" + std::string(key) + "' is not a list");
  std::vector<std::string> out;
  for (const auto& name : *found) {
    if (!name.is_string()) throw ImportError("'" + std::string(key) + "' holds what is not a name");
    out.push_back(name.get<std::string>());
  }
  return out;
}

}  // namespace

const std::vector<std::string>& supported_extensions() {
  static const std::vector<std::string> kNames = {"EXT_mesh_gpu_instancing",
                                                  "EXT_meshopt_compression",
                                                  "EXT_texture_webp",
                                                  "KHR_draco_mesh_compression",
                                                  "KHR_lights_punctual",
                                                  "KHR_materials_clearcoat",
                                                  "KHR_materials_emissive_strength",
                                                  "KHR_materials_ior",
                                                  "KHR_materials_sheen",
                                                  "KHR_materials_specular",
                                                  "KHR_materials_transmission",
                                                  "KHR_materials_unlit",
                                                  "KHR_materials_variants",
                                                  "KHR_mesh_quantization",
                                                  "KHR_meshopt_compression",
                                                  "KHR_texture_transform"};
  return kNames;
}

void check_extensions(const nlohmann::json& json, std::vector<std::string>& warnings) {
  for (const std::string& extension : names(json, "extensionsRequired")) {
    if (!supported(extension)) throw ImportError("needs the unsupported extension " + extension);
  }
  std::string ignored;
  for (const std::string& extension : names(json, "extensionsUsed")) {
    if (!supported(extension)) ignored += (ignored.empty() ? "" : ", ") + extension;
  }
  if (!ignored.empty()) warnings.push_back("unsupported extensions are ignored: " + ignored);
}

}  // namespace planecast::render
