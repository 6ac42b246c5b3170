#include <meshoptimizer.h>

#include <string>

#include "render/gltf/accessors.h"
#include "render/gltf/document.h"

namespace planecast::render {
namespace {

using nlohmann::json;

/// As much as a model may hold uncompressed; a few bytes could promise any amount.
constexpr std::size_t kMaxDecodedBytes = std::size_t{1} << 30U;

const json* compression_of(const json& view) {
  const auto extensions = view.find("extensions");
  if (extensions == view.end() || !extensions->is_object()) return nullptr;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const auto found = extensions->find(name);
    if (found != extensions->end() && found->is_object()) return &*found;
  }
  return nullptr;
}

void apply_filter(const std::string& filter, Bytes& bytes, std::size_t count, std::size_t stride,
                  const std::string& what) {
  if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  } else if (filter == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  } else if (filter == "EXPONENTIAL" && stride % 4 == 0) {
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  } else if (filter != "NONE") {
    throw ImportError(what + " uses the meshopt filter " + filter + " in a way that is unknown");
  }
}

/// Bounds as the decoder expects them without checking (EXT_meshopt_compression, "Mode").
Bytes decode(const json& compression, const unsigned char* data, std::size_t size,
             const std::string& what) {
  const std::size_t count = whole_number(compression, "count", 0);
  const std::size_t stride = whole_number(compression, "byteStride", 0);
  const std::string mode = compression.value("mode", "");
  if (stride == 0 || stride > 256 || count > kMaxDecodedBytes / stride) {
    throw ImportError(what + " has a wrong meshopt size");
  }
  Bytes bytes(count * stride);
  int status = -1;
  const bool index_sized = stride == 2 || stride == 4;
  if (mode == "ATTRIBUTES" && stride % 4 == 0) {
    status = meshopt_decodeVertexBuffer(bytes.data(), count, stride, data, size);
  } else if (mode == "TRIANGLES" && index_sized && count % 3 == 0) {
    status = meshopt_decodeIndexBuffer(bytes.data(), count, stride, data, size);
  } else if (mode == "INDICES" && index_sized) {
    status = meshopt_decodeIndexSequence(bytes.data(), count, stride, data, size);
  }
  if (status != 0) throw ImportError(what + " has meshopt data that cannot be decoded");
  if (mode == "ATTRIBUTES") {
    apply_filter(compression.value("filter", "NONE"), bytes, count, stride, what);
  }
  return bytes;
}

}  // namespace

void unpack_meshopt(GltfDocument& document) {
  const auto views = document.json.find("bufferViews");
  if (views == document.json.end() || !views->is_array()) return;
  std::size_t total = 0;
  for (std::size_t i = 0; i < views->size(); ++i) {
    json& view = (*views)[i];
    const json* compression = view.is_object() ? compression_of(view) : nullptr;
    if (compression == nullptr) continue;
    const std::string what = "buffer view " + std::to_string(i);
    const std::size_t buffer = whole_number(*compression, "buffer", SIZE_MAX);
    if (buffer >= document.buffers.size()) throw ImportError(what + " uses a missing buffer");
    const std::size_t offset = whole_number(*compression, "byteOffset", 0);
    const std::size_t length = whole_number(*compression, "byteLength", 0);
    const Bytes& source = document.buffers[buffer];
    if (offset > source.size() || length > source.size() - offset) {
      throw ImportError(what + " lies beyond the end of its buffer");
    }
    Bytes bytes = decode(*compression, source.data() + offset, length, what);
    total += bytes.size();
    if (total > kMaxDecodedBytes) throw ImportError("the decompressed buffers are too large");
    view.erase("extensions");
    view["buffer"] = document.buffers.size();
    view["byteOffset"] = 0;
    view["byteLength"] = bytes.size();
    document.buffers.push_back(std::move(bytes));
  }
}

}  // namespace planecast::render
