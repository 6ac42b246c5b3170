#include "engine/output/glb_builder.h"

#include <algorithm>
#include <sstream>

namespace planecast::engine {
namespace {

constexpr int kNoTarget = 0;

std::size_t components_of(int type) {
  switch (type) {
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    default:
      return 1;
  }
}

template <std::size_t N, typename T>
std::span<const T> flat(const std::vector<std::array<T, N>>& values) {
  return {values.empty() ? nullptr : values.front().data(), values.size() * N};
}

}  // namespace

GlbBuilder::GlbBuilder() {
  model.asset.version = "2.0";
  model.asset.generator = "planecast";
  model.buffers.emplace_back();
}

template <typename T>
int GlbBuilder::add(std::span<const T> values, int component_type, int type, int target) {
  std::vector<unsigned char>& data = model.buffers[0].data;
  while (data.size() % 4 != 0) data.push_back(0);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = data.size();
  view.byteLength = values.size_bytes();
  view.target = target;
  const auto* begin = reinterpret_cast<const unsigned char*>(values.data());
  data.insert(data.end(), begin, begin + values.size_bytes());

  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  accessor.componentType = component_type;
  accessor.type = type;
  accessor.count = values.size() / components_of(type);
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size()) - 1;
}

void GlbBuilder::set_bounds(int accessor, std::span<const float> values, std::size_t components) {
  tinygltf::Accessor& target = model.accessors[static_cast<std::size_t>(accessor)];
  for (std::size_t c = 0; c < components && c < values.size(); ++c) {
    float low = values[c];
    float high = values[c];
    for (std::size_t i = c; i < values.size(); i += components) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    target.minValues.push_back(low);
    target.maxValues.push_back(high);
  }
}

int GlbBuilder::add_positions(const std::vector<std::array<float, 3>>& positions) {
  const int accessor = add(flat(positions), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3,
                           TINYGLTF_TARGET_ARRAY_BUFFER);
  set_bounds(accessor, flat(positions), 3);
  return accessor;
}

int GlbBuilder::add_colors(const std::vector<std::array<std::uint16_t, 4>>& colors) {
  const int accessor = add(flat(colors), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4,
                           TINYGLTF_TARGET_ARRAY_BUFFER);
  model.accessors.back().normalized = true;
  return accessor;
}

int GlbBuilder::add_indices(const std::vector<std::uint32_t>& indices) {
  return add(std::span<const std::uint32_t>(indices), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
             TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

int GlbBuilder::add_times(const std::vector<float>& seconds) {
  const std::span<const float> values(seconds);
  const int accessor = add(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, kNoTarget);
  set_bounds(accessor, values, 1);
  return accessor;
}

int GlbBuilder::add_vectors(const std::vector<std::array<float, 3>>& vectors) {
  return add(flat(vectors), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, kNoTarget);
}

int GlbBuilder::add_quaternions(const std::vector<std::array<float, 4>>& quaternions) {
  return add(flat(quaternions), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, kNoTarget);
}

std::string GlbBuilder::bytes() {
  // A model without any geometry must not have an empty buffer.
  if (model.buffers[0].data.empty()) model.buffers.clear();
  std::ostringstream stream;
  tinygltf::TinyGLTF writer;
  const bool written = writer.WriteGltfSceneToStream(&model, stream, false, true);
  return written ? stream.str() : std::string();
}

}  // namespace planecast::engine
