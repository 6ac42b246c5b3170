#include "render/gltf/primitives.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/gltf/accessors.h"
#include "render/gltf/materials.h"
#include "render/gltf/simplify.h"
#include "render/gltf/tangents.h"

namespace planecast::render {
namespace {

using Attributes = std::map<std::string, int>;

int attribute(const Attributes& attributes, const char* name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

/// Strips and fans become lists; winding as in glTF 2.0, 3.7.2.1. Incomplete triangles are dropped.
std::vector<std::uint32_t> triangle_list(const std::vector<std::uint32_t>& in, int mode) {
  std::vector<std::uint32_t> out;
  const std::size_t count = in.size() < 3 ? 0 : in.size() - 2;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    out.assign(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(in.size() / 3 * 3));
  } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t odd = i % 2;
      out.insert(out.end(), {in[i], in[i + 1 + odd], in[i + 2 - odd]});
    }
  } else {
    for (std::size_t i = 0; i < count; ++i) out.insert(out.end(), {in[0], in[i + 1], in[i + 2]});
  }
  return out;
}

/// Strips and loops become pairs.
std::vector<std::uint32_t> line_list(const std::vector<std::uint32_t>& in, int mode) {
  if (mode == TINYGLTF_MODE_LINE) {
    return {in.begin(), in.begin() + static_cast<std::ptrdiff_t>(in.size() / 2 * 2)};
  }
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i + 1 < in.size(); ++i) out.insert(out.end(), {in[i], in[i + 1]});
  if (mode == TINYGLTF_MODE_LINE_LOOP && in.size() > 2) {
    out.insert(out.end(), {in.back(), in.front()});
  }
  return out;
}

Topology topology_of(int mode) {
  if (mode == TINYGLTF_MODE_POINTS) return Topology::kPoints;
  return mode < TINYGLTF_MODE_TRIANGLES ? Topology::kLines : Topology::kTriangles;
}

std::vector<std::uint32_t> plain_list(const std::vector<std::uint32_t>& in, int mode) {
  switch (topology_of(mode)) {
    case Topology::kPoints:
      return in;
    case Topology::kLines:
      return line_list(in, mode);
    case Topology::kTriangles:
      break;
  }
  return triangle_list(in, mode);
}

class PrimitiveImporter {
 public:
  PrimitiveImporter(const tinygltf::Model& file, const tinygltf::Primitive& from)
      : reader_(file), from_(from) {}

  Primitive run(const std::vector<Material>& materials, int variant,
                std::vector<std::string>& warnings) {
    read_positions();
    read_indices();
    read_normals_and_tangents();
    read_surface();
    read_skinning(warnings);
    for (const Attributes& target : from_.targets) read_target(target);
    const int last = static_cast<int>(materials.size()) - 1;
    const int material = material_of(from_, variant);
    if (material >= last) throw ImportError("a mesh uses a material that does not exist");
    out_.material = material < 0 ? last : material;
    if (out_.topology == Topology::kTriangles) {
      finish_triangles(materials[static_cast<std::size_t>(out_.material)]);
    } else {
      out_.unlit = !has_normals_;
    }
    measure();
    return std::move(out_);
  }

 private:
  /// Floats of an attribute, which must have as many elements as there are positions.
  std::vector<float> stream(int accessor, int components) const {
    if (reader_.count(accessor) != out_.shape.size()) {
      throw ImportError("a mesh has attributes of different lengths");
    }
    return reader_.floats(accessor, components);
  }

  void read_positions() {
    const auto values = reader_.floats(attribute(from_.attributes, "POSITION"), 3);
    out_.shape.resize(values.size() / 3);
    for (std::size_t i = 0; i < out_.shape.size(); ++i) {
      out_.shape[i].position = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
      const glm::vec3& p = out_.shape[i].position;
      if (!std::isfinite(p.x + p.y + p.z)) throw ImportError("a vertex position is not a number");
    }
    out_.surface.resize(out_.shape.size());
  }

  void read_indices() {
    std::vector<std::uint32_t> indices;
    if (from_.indices >= 0) {
      indices = reader_.integers(from_.indices, 1);
    } else {
      indices.resize(out_.shape.size());
      std::iota(indices.begin(), indices.end(), 0U);
    }
    if (std::any_of(indices.begin(), indices.end(),
                    [&](std::uint32_t index) { return index >= out_.shape.size(); })) {
      throw ImportError("indices point beyond the vertices");
    }
    const int mode = from_.mode < 0 ? TINYGLTF_MODE_TRIANGLES : from_.mode;
    out_.topology = topology_of(mode);
    out_.indices = plain_list(indices, mode);
  }

  void read_normals_and_tangents() {
    const int normals = attribute(from_.attributes, "NORMAL");
    if (normals < 0) return;
    const auto n = stream(normals, 3);
    for (std::size_t i = 0; i < out_.shape.size(); ++i) {
      const glm::vec3 normal(n[3 * i], n[3 * i + 1], n[3 * i + 2]);
      const float length = glm::length(normal);
      const bool usable = std::isfinite(length) && length > 0.0F;
      out_.shape[i].normal = usable ? normal / length : glm::vec3(0.0F, 0.0F, 1.0F);
    }
    has_normals_ = true;
    const int tangents = attribute(from_.attributes, "TANGENT");
    if (tangents < 0) return;
    const auto t = stream(tangents, 4);
    for (std::size_t i = 0; i < out_.shape.size(); ++i) {
      out_.shape[i].tangent = {t[4 * i], t[4 * i + 1], t[4 * i + 2], t[4 * i + 3]};
    }
    has_tangents_ = true;
  }

  void read_surface() {
    if (const int uv = attribute(from_.attributes, "TEXCOORD_0"); uv >= 0) {
      const auto values = stream(uv, 2);
      for (std::size_t i = 0; i < out_.surface.size(); ++i) {
        out_.surface[i].uv0 = {values[2 * i], values[2 * i + 1]};
      }
    }
    if (const int uv = attribute(from_.attributes, "TEXCOORD_1"); uv >= 0) {
      const auto values = stream(uv, 2);
      for (std::size_t i = 0; i < out_.surface.size(); ++i) {
        out_.surface[i].uv1 = {values[2 * i], values[2 * i + 1]};
      }
    }
    const int color = attribute(from_.attributes, "COLOR_0");
    if (color < 0) return;
    const int width = reader_.components(color);
    if (width != 3 && width != 4) throw ImportError("vertex colours have a wrong type");
    const auto values = stream(color, width);
    const auto step = static_cast<std::size_t>(width);
    for (std::size_t i = 0; i < out_.surface.size(); ++i) {
      const float* at = &values[step * i];
      out_.surface[i].color = {at[0], at[1], at[2], width == 4 ? at[3] : 1.0F};
    }
  }

  void read_skinning(std::vector<std::string>& warnings) {
    const int joints = attribute(from_.attributes, "JOINTS_0");
    const int weights = attribute(from_.attributes, "WEIGHTS_0");
    if (joints < 0 || weights < 0) return;
    if (reader_.count(joints) != out_.shape.size()) {
      throw ImportError("a mesh has attributes of different lengths");
    }
    const auto j = reader_.integers(joints, 4);
    const auto w = stream(weights, 4);
    out_.joints.resize(out_.shape.size());
    out_.joint_weights.resize(out_.shape.size());
    for (std::size_t i = 0; i < out_.shape.size(); ++i) {
      glm::vec4 weight(w[4 * i], w[4 * i + 1], w[4 * i + 2], w[4 * i + 3]);
      const float sum = weight.x + weight.y + weight.z + weight.w;
      const bool usable = std::isfinite(sum) && sum > 0.0F;
      out_.joint_weights[i] = usable ? weight / sum : glm::vec4(1.0F, 0.0F, 0.0F, 0.0F);
      for (std::size_t k = 0; k < 4; ++k) {
        out_.joints[i][k] = static_cast<std::uint16_t>(std::min(j[4 * i + k], 65535U));
      }
    }
    if (attribute(from_.attributes, "JOINTS_1") >= 0) {
      warnings.emplace_back("more than four joints a vertex: the first four are used");
    }
  }

  std::vector<glm::vec3> differences(const Attributes& target, const char* name) const {
    const int accessor = attribute(target, name);
    if (accessor < 0) return {};
    const auto values = stream(accessor, 3);
    std::vector<glm::vec3> out(out_.shape.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
      if (!std::isfinite(out[i].x + out[i].y + out[i].z)) out[i] = glm::vec3(0.0F);
    }
    return out;
  }

  void read_target(const Attributes& target) {
    out_.targets.push_back({differences(target, "POSITION"), differences(target, "NORMAL"),
                            differences(target, "TANGENT")});
  }

  void finish_triangles(const Material& material) {
    if (!has_normals_) add_flat_normals(out_);
    const TextureSlot& map =
        material.normal_map.texture >= 0 ? material.normal_map : material.clearcoat_normal_map;
    if (map.texture >= 0 && !has_tangents_) add_tangents(out_, map.uv_set);
  }

  void measure() {
    if (out_.shape.empty()) return;
    out_.box = {out_.shape.front().position, out_.shape.front().position};
    for (const ShapeVertex& vertex : out_.shape) {
      out_.box.min = glm::min(out_.box.min, vertex.position);
      out_.box.max = glm::max(out_.box.max, vertex.position);
    }
  }

  AccessorReader reader_;
  const tinygltf::Primitive& from_;
  Primitive out_;
  bool has_normals_ = false;
  bool has_tangents_ = false;
};

}  // namespace

std::optional<Primitive> import_primitive(const tinygltf::Model& file,
                                          const tinygltf::Primitive& from,
                                          const std::vector<Material>& materials, int variant,
                                          std::vector<std::string>& warnings) {
  if (from.mode > TINYGLTF_MODE_TRIANGLE_FAN) throw ImportError("a mesh has an unknown mode");
  if (attribute(from.attributes, "POSITION") < 0) {
    warnings.emplace_back("a mesh without positions is not drawn");
    return std::nullopt;
  }
  Primitive primitive = PrimitiveImporter(file, from).run(materials, variant, warnings);
  if (primitive.indices.empty()) return std::nullopt;
  add_detail_levels(primitive);
  return primitive;
}

}  // namespace planecast::render
