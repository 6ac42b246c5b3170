#include "engine/sequence/image_check.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace planecast::engine {

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
const char* const kCutOff = "the file is cut off";
const char* const kDamaged = "the file is damaged";

std::uint32_t big_endian(const Bytes& bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

std::uint32_t little_endian(const Bytes& bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = count - 1; i >= 0; --i) {
    value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  }
  return value;
}

/// Eight tables: the CRC of a picture's data is then a small share of its decoding time.
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

CrcTables make_crc_tables() {
  CrcTables tables{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t c = n;
    for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xEDB88320U ^ (c >> 1) : c >> 1;
    tables[0][n] = c;
  }
  for (std::size_t t = 1; t < tables.size(); ++t) {
    for (std::size_t n = 0; n < 256; ++n) {
      tables[t][n] = tables[0][tables[t - 1][n] & 0xFF] ^ (tables[t - 1][n] >> 8);
    }
  }
  return tables;
}

/// CRC-32 of PNG (ISO 3309), eight bytes at a time.
std::uint32_t crc32(const std::uint8_t* data, std::size_t size) {
  static const CrcTables tables = make_crc_tables();
  std::uint32_t c = 0xFFFFFFFFU;
  for (; size >= 8; size -= 8, data += 8) {
    const std::uint32_t low =
        c ^ (data[0] | static_cast<std::uint32_t>(data[1]) << 8 |
             static_cast<std::uint32_t>(data[2]) << 16 | static_cast<std::uint32_t>(data[3]) << 24);
    c = tables[7][low & 0xFF] ^ tables[6][low >> 8 & 0xFF] ^ tables[5][low >> 16 & 0xFF] ^
        tables[4][low >> 24] ^ tables[3][data[4]] ^ tables[2][data[5]] ^ tables[1][data[6]] ^
        tables[0][data[7]];
  }
  for (; size > 0; --size, ++data) c = tables[0][(c ^ *data) & 0xFF] ^ (c >> 8);
  return c ^ 0xFFFFFFFFU;
}

bool is_critical(const Bytes& bytes, std::size_t chunk) { return (bytes[chunk + 4] & 0x20) == 0; }

/// Whether so many bytes of compressed data can hold the picture at all. The decoder would make
/// room for it first, and complain on stderr.
bool png_data_suffices(const Bytes& bytes, std::size_t header, std::uint64_t data_bytes) {
  constexpr std::uint64_t kMostOfDeflate = 1032;
  constexpr std::array<std::uint64_t, 7> kChannels = {1, 0, 3, 1, 2, 0, 4};
  const std::uint64_t width = big_endian(bytes, header, 4);
  const std::uint64_t height = big_endian(bytes, header + 4, 4);
  const std::uint64_t bits = bytes[header + 8];
  const std::size_t color = bytes[header + 9];
  if (color >= kChannels.size() || bits > 16) return false;
  return data_bytes * kMostOfDeflate >= (width * bits * kChannels[color] + 7) / 8 * height;
}

ImageCheck check_png(const Bytes& bytes) {
  std::size_t header_at = 0;
  std::uint64_t data_bytes = 0;
  ImageCheck check{.known = true, .width = 0, .height = 0, .damage = kCutOff};
  std::size_t at = kPngSignature.size();
  while (at + 12 <= bytes.size()) {
    const std::size_t length = big_endian(bytes, at, 4);
    if (length > bytes.size() - at - 12) return check;
    if (is_critical(bytes, at) &&
        crc32(&bytes[at + 4], length + 4) != big_endian(bytes, at + 8 + length, 4)) {
      check.damage = kDamaged;
      return check;
    }
    const bool header = std::memcmp(&bytes[at + 4], "IHDR", 4) == 0;
    if (header != (at == kPngSignature.size())) {  // first, and once
      check.damage = kDamaged;
      return check;
    }
    if (header && length == 13) {
      header_at = at + 8;
      check.width = static_cast<int>(std::min(big_endian(bytes, at + 8, 4), 0x7FFFFFFFU));
      check.height = static_cast<int>(std::min(big_endian(bytes, at + 12, 4), 0x7FFFFFFFU));
    }
    if (std::memcmp(&bytes[at + 4], "IDAT", 4) == 0) data_bytes += length;
    if (std::memcmp(&bytes[at + 4], "IEND", 4) == 0) {
      const bool whole =
          check.width > 0 && check.height > 0 && png_data_suffices(bytes, header_at, data_bytes);
      check.damage = whole ? "" : kDamaged;
      return check;
    }
    at += length + 12;
  }
  return check;
}

bool is_start_of_frame(int marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

/// Past entropy-coded data: the place of the next marker's 0xFF, or the end.
std::size_t skip_scan_data(const Bytes& bytes, std::size_t at) {
  for (; at + 1 < bytes.size(); ++at) {
    if (bytes[at] != 0xFF) continue;
    const int next = bytes[at + 1];
    const bool restart = next >= 0xD0 && next <= 0xD7;
    if (next != 0x00 && next != 0xFF && !restart) return at;
  }
  return bytes.size();
}

ImageCheck check_jpeg(const Bytes& bytes) {
  ImageCheck check{.known = true, .width = 0, .height = 0, .damage = kCutOff};
  std::size_t at = 2;
  while (at + 2 <= bytes.size()) {
    if (bytes[at] != 0xFF) {
      check.damage = kDamaged;
      return check;
    }
    const int marker = bytes[at + 1];
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0xD9) {
      check.damage = check.width > 0 && check.height > 0 ? "" : kDamaged;
      return check;
    }
    if (at + 4 > bytes.size()) return check;
    const std::size_t length = big_endian(bytes, at + 2, 2);
    if (length < 2) {
      check.damage = kDamaged;
      return check;
    }
    if (length > bytes.size() - at - 2) return check;
    if (is_start_of_frame(marker) && length >= 8) {
      check.height = std::max(check.height, static_cast<int>(big_endian(bytes, at + 5, 2)));
      check.width = std::max(check.width, static_cast<int>(big_endian(bytes, at + 7, 2)));
    }
    at += 2 + length;
    if (marker == 0xDA) at = skip_scan_data(bytes, at);
  }
  return check;
}

ImageCheck check_bmp(const Bytes& bytes) {
  ImageCheck check{.known = true, .width = 0, .height = 0, .damage = kCutOff};
  if (bytes.size() < 54) return check;
  const std::int64_t width = static_cast<std::int32_t>(little_endian(bytes, 18, 4));
  const std::int64_t height = static_cast<std::int32_t>(little_endian(bytes, 22, 4));
  const std::int64_t rows = height < 0 ? -height : height;
  if (width <= 0 || rows == 0) {
    check.damage = kDamaged;
    return check;
  }
  check.width = static_cast<int>(width);
  check.height = static_cast<int>(std::min<std::int64_t>(rows, 0x7FFFFFFF));
  const std::int64_t bits = little_endian(bytes, 28, 2);
  const bool compressed = little_endian(bytes, 30, 4) != 0;
  const std::int64_t row_bytes = (width * bits + 31) / 32 * 4;
  const std::int64_t pixels_at = little_endian(bytes, 10, 4);
  const std::int64_t room = static_cast<std::int64_t>(bytes.size()) - pixels_at;
  const bool holds_all = row_bytes == 0 ? room >= 0 : rows <= room / row_bytes;
  if (compressed || holds_all) check.damage.clear();
  return check;
}

/// A TIFF's numbers are of the byte order that its first two bytes tell.
class TiffReader {
 public:
  explicit TiffReader(const Bytes& bytes) : bytes_(bytes), big_(bytes[0] == 'M') {}

  bool has(std::size_t at, std::size_t count) const {
    return at <= bytes_.size() && count <= bytes_.size() - at;
  }
  std::uint32_t number(std::size_t at, int count) const {
    return big_ ? big_endian(bytes_, at, count) : little_endian(bytes_, at, count);
  }
  /// The value of a directory's entry, where it is one short or long.
  std::uint32_t value(std::size_t entry) const {
    constexpr std::uint32_t kShort = 3;
    return number(entry + 8, number(entry + 2, 2) == kShort ? 2 : 4);
  }

 private:
  const Bytes& bytes_;
  bool big_;
};

ImageCheck check_tiff(const Bytes& bytes) {
  constexpr std::uint32_t kWidth = 256;
  constexpr std::uint32_t kHeight = 257;
  constexpr int kMostDirectories = 64;
  ImageCheck check{.known = true, .width = 0, .height = 0, .damage = kCutOff};
  const TiffReader tiff(bytes);
  if (!tiff.has(0, 8)) return check;
  std::size_t at = tiff.number(4, 4);
  for (int i = 0; i < kMostDirectories && at != 0; ++i) {
    if (!tiff.has(at, 2)) return check;
    const std::size_t entries = tiff.number(at, 2);
    if (!tiff.has(at, 2 + 12 * entries + 4)) return check;
    for (std::size_t entry = at + 2; entry < at + 2 + 12 * entries; entry += 12) {
      const std::uint32_t tag = tiff.number(entry, 2);
      const auto value = static_cast<int>(std::min(tiff.value(entry), 0x7FFFFFFFU));
      if (tag == kWidth) check.width = std::max(check.width, value);
      if (tag == kHeight) check.height = std::max(check.height, value);
    }
    at = tiff.number(at + 2 + 12 * entries, 4);
  }
  check.damage = check.width > 0 && check.height > 0 ? "" : kDamaged;
  return check;
}

bool is_tiff(const Bytes& bytes) {
  return bytes.size() >= 4 &&
         (std::memcmp(bytes.data(), "II*\0", 4) == 0 || std::memcmp(bytes.data(), "MM\0*", 4) == 0);
}

}  // namespace

ImageCheck check_image_file(const std::vector<std::uint8_t>& bytes) {
  if (bytes.empty()) return {.known = true, .width = 0, .height = 0, .damage = "the file is empty"};
  if (bytes.size() >= kPngSignature.size() &&
      std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin())) {
    return check_png(bytes);
  }
  if (bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF) {
    return check_jpeg(bytes);
  }
  if (bytes.size() >= 2 && bytes[0] == 'B' && bytes[1] == 'M') return check_bmp(bytes);
  if (is_tiff(bytes)) return check_tiff(bytes);
  return {};
}

}  // namespace planecast::engine
