#include "render/gltf/accessors.h"

#include <tiny_gltf.h>

#include <cstring>
#include <limits>
#include <span>

namespace planecast::render {
namespace {

/// More elements than any model of ours has; keeps a lying file from exhausting the memory.
constexpr std::size_t kMaxElements = std::size_t{1} << 26U;

/// Elements of one buffer view: `stride` bytes from one to the next.
struct ElementView {
  std::span<const unsigned char> bytes;
  std::size_t stride = 0;
};

const tinygltf::Accessor& accessor_at(const tinygltf::Model& file, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= file.accessors.size()) {
    throw ImportError("accessor " + std::to_string(index) + " does not exist");
  }
  return file.accessors[static_cast<std::size_t>(index)];
}

/// `what` names the accessor in messages.
ElementView view_elements(const tinygltf::Model& file, int view_index, std::size_t offset,
                          std::size_t count, std::size_t element_size, const std::string& what) {
  if (view_index < 0 || static_cast<std::size_t>(view_index) >= file.bufferViews.size()) {
    throw ImportError(what + " uses a buffer view that does not exist");
  }
  const auto& view = file.bufferViews[static_cast<std::size_t>(view_index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= file.buffers.size()) {
    throw ImportError(what + " uses a buffer that does not exist");
  }
  const auto& data = file.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) {
    throw ImportError(what + " lies beyond the end of its buffer");
  }
  const std::size_t stride = view.byteStride == 0 ? element_size : view.byteStride;
  if (stride < element_size || stride > 4096) throw ImportError(what + " has a wrong byte stride");
  const std::size_t needed = count == 0 ? 0 : (count - 1) * stride + element_size;
  if (offset > view.byteLength || needed > view.byteLength - offset) {
    throw ImportError(what + " lies beyond the end of its buffer view");
  }
  return {std::span(data).subspan(view.byteOffset + offset, needed), stride};
}

template <typename T>
double component(const unsigned char* at, bool normalized) {
  T value{};
  std::memcpy(&value, at, sizeof(T));
  double result = static_cast<double>(value);
  if constexpr (std::numeric_limits<T>::is_integer) {
    if (normalized) {
      result = std::max(-1.0, result / static_cast<double>(std::numeric_limits<T>::max()));
    }
  }
  return result;
}

double read_component(const unsigned char* at, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return component<std::int8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return component<std::uint8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return component<std::int16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return component<std::uint16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return component<std::uint32_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return component<float>(at, normalized);
    default:
      throw ImportError("an accessor has an unknown component type");
  }
}

/// Bytes of one component; also the check that the type is one of glTF's.
std::size_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      throw ImportError("an accessor has an unknown component type");
  }
}

/// Offset of component `i` in an element: matrix columns start at multiples of four bytes.
std::size_t component_offset(int gltf_type, std::size_t size, std::size_t i) {
  const std::size_t rows = gltf_type == TINYGLTF_TYPE_MAT2   ? 2
                           : gltf_type == TINYGLTF_TYPE_MAT3 ? 3
                                                             : 0;
  if (rows == 0) return i * size;
  const std::size_t column = (rows * size + 3) / 4 * 4;
  return i / rows * column + i % rows * size;
}

template <typename T>
void copy_elements(const ElementView& view, const tinygltf::Accessor& accessor, std::size_t width,
                   std::span<const std::uint32_t> targets, std::vector<T>& out) {
  const std::size_t size = component_size(accessor.componentType);
  const std::size_t count = targets.empty() ? out.size() / width : targets.size();
  for (std::size_t element = 0; element < count; ++element) {
    const unsigned char* at = view.bytes.data() + element * view.stride;
    T* to = &out[(targets.empty() ? element : targets[element]) * width];
    for (std::size_t i = 0; i < width; ++i) {
      to[i] = static_cast<T>(read_component(at + component_offset(accessor.type, size, i),
                                            accessor.componentType, accessor.normalized));
    }
  }
}

std::vector<std::uint32_t> sparse_targets(const tinygltf::Model& file,
                                          const tinygltf::Accessor& accessor,
                                          const std::string& what) {
  const auto& indices = accessor.sparse.indices;
  const auto count = static_cast<std::size_t>(accessor.sparse.count);
  const bool sized = accessor.sparse.count > 0 && count <= accessor.count;
  const bool integer = indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                       indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                       indices.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (!sized || !integer || indices.byteOffset < 0) {
    throw ImportError(what + " has wrong sparse indices");
  }
  const std::size_t size = component_size(indices.componentType);
  const ElementView view = view_elements(
      file, indices.bufferView, static_cast<std::size_t>(indices.byteOffset), count, size, what);
  std::vector<std::uint32_t> targets(count);
  for (std::size_t i = 0; i < count; ++i) {
    targets[i] = static_cast<std::uint32_t>(
        read_component(view.bytes.data() + i * view.stride, indices.componentType, false));
    if (targets[i] >= accessor.count) throw ImportError(what + " has wrong sparse indices");
  }
  return targets;
}

template <typename T>
std::vector<T> read_all(const tinygltf::Model& file, int index, int components) {
  const auto& accessor = accessor_at(file, index);
  const std::string what = "accessor " + std::to_string(index);
  if (accessor.count == 0 || accessor.count > kMaxElements) {
    throw ImportError(what + " has a wrong count");
  }
  if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) != components) {
    throw ImportError(what + " has a wrong type");
  }
  const auto width = static_cast<std::size_t>(components);
  const std::size_t size = component_size(accessor.componentType);
  const std::size_t element = component_offset(accessor.type, size, width - 1) + size;
  std::vector<T> out(accessor.count * width);
  if (accessor.bufferView >= 0) {
    copy_elements(view_elements(file, accessor.bufferView, accessor.byteOffset, accessor.count,
                                element, what),
                  accessor, width, {}, out);
  }
  if (accessor.sparse.isSparse) {
    const auto targets = sparse_targets(file, accessor, what);
    if (accessor.sparse.values.byteOffset < 0) throw ImportError(what + " has wrong sparse values");
    const ElementView values = view_elements(
        file, accessor.sparse.values.bufferView,
        static_cast<std::size_t>(accessor.sparse.values.byteOffset), targets.size(), element, what);
    copy_elements(values, accessor, width, targets, out);
  }
  return out;
}

}  // namespace

std::size_t AccessorReader::count(int accessor) const {
  return accessor_at(*file_, accessor).count;
}

int AccessorReader::components(int accessor) const {
  return tinygltf::GetNumComponentsInType(
      static_cast<std::uint32_t>(accessor_at(*file_, accessor).type));
}

std::vector<float> AccessorReader::floats(int accessor, int components) const {
  return read_all<float>(*file_, accessor, components);
}

std::vector<std::uint32_t> AccessorReader::integers(int accessor, int components) const {
  const int type = accessor_at(*file_, accessor).componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    throw ImportError("accessor " + std::to_string(accessor) + " must hold unsigned integers");
  }
  return read_all<std::uint32_t>(*file_, accessor, components);
}

}  // namespace planecast::render
