#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace planecast::render {

using Bytes = std::vector<unsigned char>;

/// A glTF file with everything it refers to in memory, nothing of it interpreted yet. What a URI
/// may name: a data URI, or a file below the model's own folder.
struct GltfDocument {
  nlohmann::json json;
  std::vector<Bytes> buffers;  ///< as long as their byteLength says, or longer
  std::vector<Bytes> images;   ///< encoded; empty where one could not be read
};

/// Reads a .gltf or .glb file (glTF 2.0, sections 3.6.1 and 4.4), undoes compression of buffer
/// views (meshopt) and primitives (Draco). Throws ImportError. Images that cannot be read are
/// warned of and stay empty.
GltfDocument read_document(const std::string& path, std::vector<std::string>& warnings);

/// The bytes of a buffer view; throws ImportError when it does not lie within its buffer.
struct ViewBytes {
  const unsigned char* data = nullptr;
  std::size_t size = 0;
};
ViewBytes view_bytes(const GltfDocument& document, std::size_t view);

/// Appends a buffer of its own for `bytes` and a view over all of it; returns the view's index.
std::size_t add_view(GltfDocument& document, Bytes bytes);

/// Value of `key` as a count or index, or `otherwise` when it is absent. Throws ImportError for
/// anything that is not a whole number from 0 on.
std::size_t whole_number(const nlohmann::json& object, const char* key, std::size_t otherwise);

/// Replaces every buffer view that EXT_meshopt_compression (or its KHR successor) describes by one
/// over the decoded bytes. Throws ImportError for streams that do not decode.
void unpack_meshopt(GltfDocument& document);

/// Replaces the attributes and indices of primitives with KHR_draco_mesh_compression by accessors
/// over the decoded values. Throws ImportError for streams that do not decode.
void unpack_draco(GltfDocument& document);

}  // namespace planecast::render
