#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace planecast::slam {

static_assert(std::endian::native == std::endian::little,
              "numbers are dumped as they lie in memory");

/// Appends numbers and strings to a byte string, little endian.
class ByteWriter {
 public:
  template <typename T>
  requires std::is_arithmetic_v<T>
  void put(T value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T)); }
  void put(std::string_view text) {
    put(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The reverse. Every read is checked against the end: after the first that runs over it all reads
/// give nothing and ok() is false, so that no bytes can make it read beyond.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_arithmetic_v<T> T number() {
    T value{};
    const std::string_view taken = take(sizeof(T));
    if (ok_) std::memcpy(&value, taken.data(), sizeof(T));
    return value;
  }
  std::string text() { return std::string(take(number<std::uint64_t>())); }
  /// Number of items that follow, each of at least `item_bytes`; 0 where so many cannot.
  std::size_t count(std::size_t item_bytes) {
    const auto items = number<std::uint64_t>();
    if (items > bytes_.size() / item_bytes) ok_ = false;
    return ok_ ? static_cast<std::size_t>(items) : 0;
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) ok_ = false;
    if (!ok_) return {};
    const std::string_view taken = bytes_.substr(0, static_cast<std::size_t>(size));
    bytes_.remove_prefix(static_cast<std::size_t>(size));
    return taken;
  }
  /// What is left.
  std::string_view rest() const { return bytes_; }
  bool at_end() const { return bytes_.empty(); }
  bool ok() const { return ok_; }
  void fail() { ok_ = false; }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

/// FNV-1a, 64 bits: finds what was damaged by accident.
inline std::uint64_t checksum_of(std::string_view bytes) {
  std::uint64_t hash = 1469598103934665603ULL;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

}  // namespace planecast::slam
