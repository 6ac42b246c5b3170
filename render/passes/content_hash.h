#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

namespace planecast::render {

/// 64-bit hash of contents, eight bytes a step: to know a polygon or a mesh again, not for
/// security.
class ContentHash {
 public:
  template <typename T>
  void add(const std::vector<T>& values) {
    add_bytes(values.data(), values.size() * sizeof(T));
  }
  template <typename T>
  void add(const T& value) {
    add_bytes(&value, sizeof(T));
  }
  std::uint64_t value() const { return state_; }

 private:
  void add_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    mix(size);
    for (; size >= 8; size -= 8, bytes += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes, 8);
      mix(word);
    }
    std::uint64_t rest = 0;
    if (size > 0) std::memcpy(&rest, bytes, size);
    mix(rest);
  }
  /// Multiply and fold, with the golden ratio's bits as the odd multiplier.
  void mix(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x9E3779B97F4A7C15ULL;
    state_ ^= state_ >> 32U;
  }

  std::uint64_t state_ = 0x243F6A8885A308D3ULL;
};

}  // namespace planecast::render
