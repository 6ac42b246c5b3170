#include "render/gltf/materials.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

#include "render/gltf/accessors.h"

namespace planecast::render {
namespace {

int image_of(const tinygltf::Texture& from) {
  const auto webp = from.extensions.find("EXT_texture_webp");
  if (webp != from.extensions.end() && webp->second.Has("source") &&
      webp->second.Get("source").IsInt()) {
    return webp->second.Get("source").GetNumberAsInt();
  }
  return from.source;
}

ModelTexture convert_texture(const tinygltf::Model& file, const tinygltf::Texture& from,
                             std::size_t images, std::size_t index) {
  ModelTexture texture;
  texture.image = image_of(from);
  if (texture.image >= static_cast<int>(images) ||
      from.sampler >= static_cast<int>(file.samplers.size())) {
    throw ImportError("texture " + std::to_string(index) + " uses what does not exist");
  }
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
    material.base_color_map = slot(pbr.baseColorTexture);
    material.metallic_roughness_map = slot(pbr.metallicRoughnessTexture);
    material.normal_map = slot(from.normalTexture);
    material.occlusion_map = slot(from.occlusionTexture);
    material.emissive_map = slot(from.emissiveTexture);
    for (const auto& [name, value] : from.extensions) {
      if (value.IsObject()) apply_extension(name, value, material);
    }
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

  static void read(const tinygltf::Value& object, const char* key, float& out) {
    if (!object.Has(key) || !object.Get(key).IsNumber()) return;
    out = static_cast<float>(object.Get(key).GetNumberAsDouble());
  }
  static void read(const tinygltf::Value& object, const char* key, glm::vec3& out) {
    if (!object.Has(key) || !object.Get(key).IsArray()) return;
    const auto& list = object.Get(key);
    for (std::size_t i = 0; i < std::min<std::size_t>(3, list.ArrayLen()); ++i) {
      const auto& item = list.Get(static_cast<int>(i));
      if (item.IsNumber()) out[static_cast<int>(i)] = static_cast<float>(item.GetNumberAsDouble());
    }
  }

  /// A texture reference of an extension, which the parser leaves as it stands.
  TextureSlot slot(const tinygltf::Value& object, const char* key) {
    tinygltf::TextureInfo info;
    if (!object.Has(key) || !object.Get(key).IsObject()) return {};
    const auto& value = object.Get(key);
    const auto integer = [&value](const char* name, int otherwise) {
      return value.Has(name) && value.Get(name).IsInt() ? value.Get(name).GetNumberAsInt()
                                                        : otherwise;
    };
    info.index = integer("index", -1);
    info.texCoord = integer("texCoord", 0);
    if (value.Has("extensions") && value.Get("extensions").Has("KHR_texture_transform")) {
      info.extensions["KHR_texture_transform"] =
          value.Get("extensions").Get("KHR_texture_transform");
    }
    return slot(info);
  }

  void apply_extension(const std::string& name, const tinygltf::Value& value, Material& material) {
    if (name == "KHR_materials_emissive_strength") {
      float strength = 1.0F;
      read(value, "emissiveStrength", strength);
      material.emissive *= strength;
    } else if (name == "KHR_materials_ior") {
      read(value, "ior", material.ior);
    } else if (name == "KHR_materials_specular") {
      read(value, "specularFactor", material.specular);
      read(value, "specularColorFactor", material.specular_color);
      material.specular_map = slot(value, "specularTexture");
      material.specular_color_map = slot(value, "specularColorTexture");
    } else if (name == "KHR_materials_transmission") {
      read(value, "transmissionFactor", material.transmission);
      material.transmission_map = slot(value, "transmissionTexture");
    } else if (name == "KHR_materials_clearcoat") {
      read(value, "clearcoatFactor", material.clearcoat);
      read(value, "clearcoatRoughnessFactor", material.clearcoat_roughness);
      material.clearcoat_map = slot(value, "clearcoatTexture");
      material.clearcoat_roughness_map = slot(value, "clearcoatRoughnessTexture");
      material.clearcoat_normal_map = slot(value, "clearcoatNormalTexture");
      if (value.Has("clearcoatNormalTexture")) {
        read(value.Get("clearcoatNormalTexture"), "scale", material.clearcoat_normal_scale);
      }
    } else if (name == "KHR_materials_sheen") {
      read(value, "sheenColorFactor", material.sheen_color);
      read(value, "sheenRoughnessFactor", material.sheen_roughness);
      material.sheen_color_map = slot(value, "sheenColorTexture");
      material.sheen_roughness_map = slot(value, "sheenRoughnessTexture");
    }
  }

  const Model& model_;
  std::vector<std::string>& warnings_;
};

}  // namespace

void import_materials(const tinygltf::Model& file, Model& model,
                      std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < file.textures.size(); ++i) {
    model.textures.push_back(convert_texture(file, file.textures[i], model.images.size(), i));
  }
  MaterialImporter importer(model, warnings);
  for (const auto& material : file.materials) model.materials.push_back(importer.convert(material));
  model.materials.emplace_back();
}

int find_variant(const tinygltf::Model& file, const std::string& name, Model& model) {
  const auto found = file.extensions.find("KHR_materials_variants");
  if (found != file.extensions.end() && found->second.Has("variants")) {
    const auto& variants = found->second.Get("variants");
    for (std::size_t i = 0; i < variants.ArrayLen(); ++i) {
      const auto& variant = variants.Get(static_cast<int>(i));
      const bool named = variant.Has("name") && variant.Get("name").IsString();
      model.variant_names.push_back(named ? variant.Get("name").Get<std::string>() : "");
    }
  }
  if (name.empty()) return -1;
  const auto wanted = std::ranges::find(model.variant_names, name);
  if (wanted == model.variant_names.end()) throw ImportError("has no variant '" + name + "'");
  return static_cast<int>(wanted - model.variant_names.begin());
}

int material_of(const tinygltf::Primitive& primitive, int variant) {
  const auto found = primitive.extensions.find("KHR_materials_variants");
  if (variant < 0 || found == primitive.extensions.end() || !found->second.Has("mappings")) {
    return primitive.material;
  }
  const auto& mappings = found->second.Get("mappings");
  for (std::size_t i = 0; i < mappings.ArrayLen(); ++i) {
    const auto& mapping = mappings.Get(static_cast<int>(i));
    if (!mapping.Has("variants") || !mapping.Has("material")) continue;
    const auto& variants = mapping.Get("variants");
    for (std::size_t k = 0; k < variants.ArrayLen(); ++k) {
      const auto& item = variants.Get(static_cast<int>(k));
      if (item.IsInt() && item.GetNumberAsInt() == variant && mapping.Get("material").IsInt()) {
        return mapping.Get("material").GetNumberAsInt();
      }
    }
  }
  return primitive.material;
}

}  // namespace planecast::render
