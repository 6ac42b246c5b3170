#include "render/gltf/materials.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

#include "render/gltf/accessors.h"

namespace planecast::render {
namespace {

ImageU8 convert_image(const tinygltf::Image& from) {
  if (from.width <= 0 || from.height <= 0 || from.component < 1 || from.component > 4) return {};
  ImageU8 image(from.width, from.height, from.component);
  const std::size_t bytes = from.bits == 16 ? 2 : 1;
  if (from.bits > 16 || from.image.size() < image.pixels.size() * bytes) return {};
  // Of a 16-bit sample the high byte (little endian) is what an 8-bit texture can hold.
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = from.image[i * bytes + bytes - 1];
  }
  return image;
}

ModelTexture convert_texture(const tinygltf::Model& file, const tinygltf::Texture& from,
                             std::size_t index) {
  ModelTexture texture;
  if (from.source >= static_cast<int>(file.images.size()) ||
      from.sampler >= static_cast<int>(file.samplers.size())) {
    throw ImportError("texture " + std::to_string(index) + " uses what does not exist");
  }
  texture.image = from.source;
  if (from.sampler < 0) return texture;
  const auto& sampler = file.samplers[static_cast<std::size_t>(from.sampler)];
  const auto one_of = [](int value, std::initializer_list<int> allowed, int otherwise) {
    return std::find(allowed.begin(), allowed.end(), value) != allowed.end() ? value : otherwise;
  };
  texture.min_filter = one_of(sampler.minFilter, {9728, 9729, 9984, 9985, 9986}, 9987);
  texture.mag_filter = one_of(sampler.magFilter, {9728}, 9729);
  texture.wrap_s = one_of(sampler.wrapS, {33071, 33648}, 10497);
  texture.wrap_t = one_of(sampler.wrapT, {33071, 33648}, 10497);
  return texture;
}

glm::vec2 read_pair(const tinygltf::Value& object, const char* key, glm::vec2 otherwise) {
  if (!object.Has(key)) return otherwise;
  const auto& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() != 2 || !value.Get(0).IsNumber() ||
      !value.Get(1).IsNumber()) {
    return otherwise;
  }
  return {static_cast<float>(value.Get(0).GetNumberAsDouble()),
          static_cast<float>(value.Get(1).GetNumberAsDouble())};
}

/// Translation * rotation * scale of the extension's text.
void apply_transform_extension(const tinygltf::ExtensionMap& extensions, TextureSlot& slot) {
  const auto found = extensions.find("KHR_texture_transform");
  if (found == extensions.end() || !found->second.IsObject()) return;
  const tinygltf::Value& value = found->second;
  const glm::vec2 offset = read_pair(value, "offset", {0.0F, 0.0F});
  const glm::vec2 scale = read_pair(value, "scale", {1.0F, 1.0F});
  float angle = 0.0F;
  if (value.Has("rotation") && value.Get("rotation").IsNumber()) {
    angle = static_cast<float>(value.Get("rotation").GetNumberAsDouble());
  }
  const float c = std::cos(angle);
  const float s = std::sin(angle);
  slot.transform = glm::mat3(glm::vec3(c * scale.x, -s * scale.x, 0.0F),
                             glm::vec3(s * scale.y, c * scale.y, 0.0F), glm::vec3(offset, 1.0F));
  if (value.Has("texCoord") && value.Get("texCoord").IsNumber()) {
    slot.uv_set = value.Get("texCoord").GetNumberAsInt();
  }
}

class MaterialImporter {
 public:
  MaterialImporter(const Model& model, std::vector<std::string>& warnings)
      : model_(model), warnings_(warnings) {}

  Material convert(const tinygltf::Material& from) {
    Material material;
    const auto& pbr = from.pbrMetallicRoughness;
    for (std::size_t i = 0; i < std::min<std::size_t>(4, pbr.baseColorFactor.size()); ++i) {
      material.base_color[static_cast<int>(i)] = static_cast<float>(pbr.baseColorFactor[i]);
    }
    for (std::size_t i = 0; i < std::min<std::size_t>(3, from.emissiveFactor.size()); ++i) {
      material.emissive[static_cast<int>(i)] = static_cast<float>(from.emissiveFactor[i]);
    }
    material.metallic = static_cast<float>(pbr.metallicFactor);
    material.roughness = static_cast<float>(pbr.roughnessFactor);
    material.normal_scale = static_cast<float>(from.normalTexture.scale);
    material.occlusion_strength = static_cast<float>(from.occlusionTexture.strength);
    material.alpha_cutoff = static_cast<float>(from.alphaCutoff);
    material.double_sided = from.doubleSided;
    if (from.alphaMode == "MASK") material.alpha_mode = AlphaMode::kMask;
    if (from.alphaMode == "BLEND") material.alpha_mode = AlphaMode::kBlend;
    material.unlit = from.extensions.contains("KHR_materials_unlit");
    apply_emissive_strength(from, material);
    material.base_color_map = slot(pbr.baseColorTexture);
    material.metallic_roughness_map = slot(pbr.metallicRoughnessTexture);
    material.normal_map = slot(from.normalTexture);
    material.occlusion_map = slot(from.occlusionTexture);
    material.emissive_map = slot(from.emissiveTexture);
    return material;
  }

 private:
  template <typename Info>
  TextureSlot slot(const Info& info) {
    TextureSlot slot;
    if (info.index < 0) return slot;
    if (static_cast<std::size_t>(info.index) >= model_.textures.size()) {
      throw ImportError("a material uses texture " + std::to_string(info.index) +
                        ", which does not exist");
    }
    const int image = model_.textures[static_cast<std::size_t>(info.index)].image;
    if (image < 0 || model_.images[static_cast<std::size_t>(image)].empty()) return slot;
    slot.texture = info.index;
    slot.uv_set = info.texCoord;
    apply_transform_extension(info.extensions, slot);
    if (slot.uv_set < 0 || slot.uv_set > 1) {
      warnings_.push_back("texture coordinate set " + std::to_string(slot.uv_set) +
                          " is not supported, set 0 is used");
      slot.uv_set = 0;
    }
    return slot;
  }

  static void apply_emissive_strength(const tinygltf::Material& from, Material& material) {
    const auto found = from.extensions.find("KHR_materials_emissive_strength");
    if (found == from.extensions.end() || !found->second.IsObject()) return;
    const tinygltf::Value& strength = found->second.Get("emissiveStrength");
    if (strength.IsNumber()) material.emissive *= static_cast<float>(strength.GetNumberAsDouble());
  }

  const Model& model_;
  std::vector<std::string>& warnings_;
};

}  // namespace

void import_materials(const tinygltf::Model& file, Model& model,
                      std::vector<std::string>& warnings) {
  for (const auto& image : file.images) model.images.push_back(convert_image(image));
  for (std::size_t i = 0; i < file.textures.size(); ++i) {
    model.textures.push_back(convert_texture(file, file.textures[i], i));
  }
  MaterialImporter importer(model, warnings);
  for (const auto& material : file.materials) model.materials.push_back(importer.convert(material));
  model.materials.emplace_back();
}

}  // namespace planecast::render
