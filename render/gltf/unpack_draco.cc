#include <draco/compression/decode.h>

#include <array>
#include <cstring>
#include <string>

#include "render/gltf/accessors.h"
#include "render/gltf/document.h"

namespace planecast::render {
namespace {

using nlohmann::json;

constexpr const char* kName = "KHR_draco_mesh_compression";

int components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  throw ImportError("a Draco attribute has the type " + type);
}

template <typename T>
Bytes values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int components) {
  const auto width = static_cast<std::size_t>(components);
  Bytes bytes(mesh.num_points() * width * sizeof(T));
  std::array<T, 4> value{};
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    if (!attribute.ConvertValue<T>(attribute.mapped_index(point),
                                   static_cast<std::int8_t>(components), value.data())) {
      throw ImportError("a Draco attribute cannot be converted");
    }
    std::memcpy(&bytes[point.value() * width * sizeof(T)], value.data(), width * sizeof(T));
  }
  return bytes;
}

Bytes attribute_bytes(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                      std::size_t component_type, int components) {
  switch (component_type) {
    case 5120:
      return values_of<std::int8_t>(mesh, attribute, components);
    case 5121:
      return values_of<std::uint8_t>(mesh, attribute, components);
    case 5122:
      return values_of<std::int16_t>(mesh, attribute, components);
    case 5123:
      return values_of<std::uint16_t>(mesh, attribute, components);
    case 5125:
      return values_of<std::uint32_t>(mesh, attribute, components);
    case 5126:
      return values_of<float>(mesh, attribute, components);
    default:
      throw ImportError("a Draco attribute has an unknown component type");
  }
}

std::unique_ptr<draco::Mesh> decode(const ViewBytes& view) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(view.data), view.size);
  draco::Decoder decoder;
  auto result = decoder.DecodeMeshFromBuffer(&buffer);
  if (!result.ok() || result.value() == nullptr) {
    throw ImportError("a mesh has Draco data that cannot be decoded");
  }
  return std::move(result).value();
}

/// A copy of the accessor that reads decoded bytes: others may go on using the original.
std::size_t add_accessor(GltfDocument& document, json accessor, std::size_t count, Bytes bytes) {
  for (const char* stale : {"byteOffset", "sparse"}) accessor.erase(stale);
  accessor["count"] = count;
  accessor["bufferView"] = add_view(document, std::move(bytes));
  json& accessors = document.json["accessors"];
  accessors.push_back(std::move(accessor));
  return accessors.size() - 1;
}

Bytes index_bytes(const draco::Mesh& mesh) {
  Bytes bytes(mesh.num_faces() * 3 * sizeof(std::uint32_t));
  std::size_t at = 0;
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh.face(face)) {
      const std::uint32_t index = corner.value();
      std::memcpy(&bytes[at], &index, sizeof(index));
      at += sizeof(index);
    }
  }
  return bytes;
}

void unpack_primitive(GltfDocument& document, json& primitive) {
  const json compression = primitive["extensions"][kName];
  if (!compression.is_object() || !compression.contains("attributes") ||
      !compression["attributes"].is_object()) {
    throw ImportError("a mesh has a wrong Draco extension");
  }
  const auto mesh = decode(view_bytes(document, whole_number(compression, "bufferView", SIZE_MAX)));
  for (const auto& [name, id] : compression["attributes"].items()) {
    if (!id.is_number_unsigned() || !primitive["attributes"].contains(name)) {
      throw ImportError("a mesh has a wrong Draco attribute");
    }
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(id.get<std::uint32_t>());
    const std::size_t index = whole_number(primitive["attributes"], name.c_str(), SIZE_MAX);
    if (attribute == nullptr || index >= document.json["accessors"].size()) {
      throw ImportError("a mesh has a wrong Draco attribute");
    }
    const json accessor = document.json["accessors"][index];
    Bytes bytes = attribute_bytes(*mesh, *attribute, whole_number(accessor, "componentType", 0),
                                  components_of(accessor.value("type", "")));
    primitive["attributes"][name] =
        add_accessor(document, accessor, mesh->num_points(), std::move(bytes));
  }
  const json indices = {{"componentType", 5125}, {"type", "SCALAR"}};
  primitive["indices"] =
      add_accessor(document, indices, std::size_t{mesh->num_faces()} * 3, index_bytes(*mesh));
  primitive["mode"] = 4;
  primitive["extensions"].erase(kName);
}

}  // namespace

void unpack_draco(GltfDocument& document) {
  const auto meshes = document.json.find("meshes");
  if (meshes == document.json.end() || !meshes->is_array()) return;
  for (json& mesh : *meshes) {
    if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array()) {
      continue;
    }
    for (json& primitive : mesh["primitives"]) {
      if (primitive.is_object() && primitive.contains("extensions") &&
          primitive["extensions"].is_object() && primitive["extensions"].contains(kName)) {
        unpack_primitive(document, primitive);
      }
    }
  }
}

}  // namespace planecast::render
