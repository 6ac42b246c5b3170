#include "render/gltf/document.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string_view>

#include "render/gltf/accessors.h"
#include "render/gltf/extensions.h"
#include "render/gltf/uri.h"

namespace planecast::render {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Larger files are not models for a picture; keeps a lying size from exhausting the memory.
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 31U;

Bytes read_file(const fs::path& path, const std::string& what) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw ImportError(what + "cannot be opened");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size > kMaxFileBytes) throw ImportError(what + "is too large");
  Bytes bytes(static_cast<std::size_t>(size));
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
    throw ImportError(what + "cannot be read");
  }
  return bytes;
}

std::uint32_t little_endian(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

struct Chunks {
  std::string_view json;
  std::string_view binary;
  bool has_binary = false;
};

/// A .glb file's two chunks, or a .gltf file's text.
Chunks split(const Bytes& file) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  if (!text.starts_with("glTF")) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    return {text.starts_with(kByteOrderMark) ? text.substr(3) : text, {}, false};
  }
  if (file.size() < 20) throw ImportError("is not a glTF file: it ends within its header");
  if (little_endian(file, 4) != 2) {
    throw ImportError("GLB version " + std::to_string(little_endian(file, 4)) +
                      " is not supported");
  }
  constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
  constexpr std::uint32_t kBinaryChunk = 0x004E4942;
  const std::size_t end = little_endian(file, 8);
  if (end > file.size()) throw ImportError("is cut off: its header promises more bytes");
  Chunks chunks;
  for (std::size_t at = 12; at + 8 <= end;) {
    const std::size_t length = little_endian(file, at);
    const std::uint32_t type = little_endian(file, at + 4);
    at += 8;
    if (length > end - at) throw ImportError("has a chunk that is longer than the file");
    if (type == kJsonChunk && chunks.json.empty()) chunks.json = text.substr(at, length);
    if (type == kBinaryChunk && !chunks.has_binary) {
      chunks.binary = text.substr(at, length);
      chunks.has_binary = true;
    }
    at += (length + 3) / 4 * 4;
  }
  return chunks;
}

/// The JSON library writes and frees what is nested by recursion.
void check_depth(std::string_view text) {
  constexpr int kDeepest = 256;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest) throw ImportError("is nested too deeply");
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

const json& array_of(const json& object, const char* key) {
  static const json kNone = json::array();
  const auto found = object.find(key);
  if (found == object.end()) return kNone;
  if (!found->is_array()) throw ImportError("'" + std::string(key) + "' is not a list");
  return *found;
}

Bytes fetch(const fs::path& folder, const std::string& uri, const std::string& what) {
  if (!is_data_uri(uri)) return read_file(resolve_uri(folder, uri), what + " '" + uri + "' ");
  auto bytes = decode_data_uri(uri);
  if (!bytes) throw ImportError(what + " has a data URI that cannot be decoded");
  return std::move(*bytes);
}

/// The buffer stands for what compressed views decode to; its own bytes are never looked at.
bool only_fallback(const json& buffer) {
  if (!buffer.contains("extensions") || !buffer["extensions"].is_object()) return false;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const auto found = buffer["extensions"].find(name);
    if (found != buffer["extensions"].end() && found->is_object() &&
        found->value("fallback", false)) {
      return true;
    }
  }
  return false;
}

/// Some writers leave out the mark above.
bool uses_meshopt(const json& document) {
  const json& used = array_of(document, "extensionsUsed");
  return std::ranges::any_of(used, [](const json& name) {
    return name == "EXT_meshopt_compression" || name == "KHR_meshopt_compression";
  });
}

void load_buffers(GltfDocument& document, const fs::path& folder, const Chunks& chunks) {
  const json& list = array_of(document.json, "buffers");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const json& buffer = list[i];
    const std::string what = "buffer " + std::to_string(i);
    if (!buffer.is_object()) throw ImportError(what + " is not an object");
    const std::size_t length = whole_number(buffer, "byteLength", 0);
    Bytes& bytes = document.buffers.emplace_back();
    if (only_fallback(buffer)) continue;
    const auto uri = buffer.find("uri");
    if (uri != buffer.end()) {
      if (!uri->is_string()) throw ImportError(what + " has a URI that is not text");
      bytes = fetch(folder, uri->get<std::string>(), what);
    } else if (i == 0 && chunks.has_binary) {
      bytes.assign(chunks.binary.begin(), chunks.binary.end());
    } else if (uses_meshopt(document.json)) {
      continue;
    } else {
      throw ImportError(what + " has no data");
    }
    if (bytes.size() < length) throw ImportError(what + " is shorter than its byteLength");
  }
}

void load_images(GltfDocument& document, const fs::path& folder,
                 std::vector<std::string>& warnings) {
  const json& list = array_of(document.json, "images");
  for (std::size_t i = 0; i < list.size(); ++i) {
    Bytes& bytes = document.images.emplace_back();
    const std::string what = "image " + std::to_string(i);
    if (!list[i].is_object()) throw ImportError(what + " is not an object");
    try {
      const auto uri = list[i].find("uri");
      if (uri != list[i].end() && uri->is_string()) {
        bytes = fetch(folder, uri->get<std::string>(), what);
      } else {
        const ViewBytes view = view_bytes(document, whole_number(list[i], "bufferView", SIZE_MAX));
        bytes.assign(view.data, view.data + view.size);
      }
    } catch (const ImportError& error) {
      warnings.push_back(std::string(error.what()) + ", the image is left out");
    }
  }
}

}  // namespace

std::size_t whole_number(const json& object, const char* key, std::size_t otherwise) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned()) {
    throw ImportError("'" + std::string(key) + "' is not a whole number");
  }
  return found->get<std::size_t>();
}

ViewBytes view_bytes(const GltfDocument& document, std::size_t view) {
  const json& views = array_of(document.json, "bufferViews");
  const std::string what = "buffer view " + std::to_string(view);
  if (view >= views.size() || !views[view].is_object()) throw ImportError(what + " does not exist");
  const std::size_t buffer = whole_number(views[view], "buffer", SIZE_MAX);
  if (buffer >= document.buffers.size()) throw ImportError(what + " uses a missing buffer");
  const Bytes& bytes = document.buffers[buffer];
  const std::size_t offset = whole_number(views[view], "byteOffset", 0);
  const std::size_t length = whole_number(views[view], "byteLength", 0);
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw ImportError(what + " lies beyond the end of its buffer");
  }
  return {bytes.data() + offset, length};
}

std::size_t add_view(GltfDocument& document, Bytes bytes) {
  json& views = document.json["bufferViews"];
  views.push_back({{"buffer", document.buffers.size()}, {"byteLength", bytes.size()}});
  document.buffers.push_back(std::move(bytes));
  return views.size() - 1;
}

GltfDocument read_document(const std::string& path, std::vector<std::string>& warnings) {
  const Bytes file = read_file(path, "");
  const Chunks chunks = split(file);
  GltfDocument document;
  if (chunks.json.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw ImportError("is not a glTF file");
  }
  check_depth(chunks.json);
  document.json = json::parse(chunks.json);
  if (!document.json.is_object()) throw ImportError("is not a glTF file");
  // First of all: what an unknown extension leaves out of a file is no error of the file.
  check_extensions(document.json, warnings);
  const fs::path folder = fs::path(path).parent_path();
  load_buffers(document, folder, chunks);
  unpack_meshopt(document);
  unpack_draco(document);
  load_images(document, folder, warnings);
  return document;
}

}  // namespace planecast::render
