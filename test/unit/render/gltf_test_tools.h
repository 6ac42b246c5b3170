#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "render/gltf/import.h"

namespace planecast::render::test {

/// Bytes of a glTF buffer, filled value by value.
class BufferBytes {
 public:
  template <typename T>
  BufferBytes& add(std::initializer_list<T> values) {
    for (const T& value : values) {
      const auto* from = reinterpret_cast<const unsigned char*>(&value);
      bytes_.insert(bytes_.end(), from, from + sizeof(T));
    }
    return *this;
  }
  std::size_t size() const { return bytes_.size(); }

  std::string data_uri() const {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out = "data:application/octet-stream;base64,";
    for (std::size_t i = 0; i < bytes_.size(); i += 3) {
      std::uint32_t word = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        word = word << 8U | (i + k < bytes_.size() ? bytes_[i + k] : 0U);
      }
      for (std::size_t k = 0; k < 4; ++k) {
        out += i + k <= bytes_.size() ? kDigits[word >> (18 - 6 * k) & 63U] : '=';
      }
    }
    return out;
  }

 private:
  std::vector<unsigned char> bytes_;
};

/// Imports text as if it were a .gltf file.
inline ImportResult import_text(const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("planecast_" + std::to_string(std::hash<std::string>{}(text)) + ".gltf");
  std::ofstream(path) << text;
  ImportResult result = import_gltf(path.string());
  std::filesystem::remove(path);
  return result;
}

/// Replaces the first `from` in `text`; the text must have it.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace planecast::render::test
