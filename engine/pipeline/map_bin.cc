#include "engine/pipeline/map_bin.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are dumped as they lie in memory");

constexpr std::string_view kMagic("PLNCMAP\0", 8);
constexpr std::uint32_t kVersion = 1;

/// Appends numbers, strings and vectors of either to a byte string.
class ByteWriter {
 public:
  template <typename T>
  requires std::is_arithmetic_v<T>
  void put(T value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T)); }
  void put(std::string_view text) {
    put(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
  }
  void put(const std::vector<double>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    for (const double value : values) put(value);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The reverse; every read is checked against the end, so that no file can make it read beyond.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, const std::filesystem::path& path)
      : bytes_(bytes), path_(path) {}

  template <typename T>
  requires std::is_arithmetic_v<T> T number() {
    T value{};
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string text() { return std::string(take(number<std::uint64_t>())); }
  std::vector<double> numbers() {
    std::vector<double> values(count_of(sizeof(double)));
    for (double& value : values) value = number<double>();
    return values;
  }
  /// Number of items that follow, each of at least `item_bytes`.
  std::size_t count_of(std::size_t item_bytes) {
    const auto count = number<std::uint64_t>();
    if (count > bytes_.size() / item_bytes) fail("is broken");
    return static_cast<std::size_t>(count);
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) fail("is truncated");
    const std::string_view taken = bytes_.substr(0, static_cast<std::size_t>(size));
    bytes_.remove_prefix(static_cast<std::size_t>(size));
    return taken;
  }
  bool at_end() const { return bytes_.empty(); }
  [[noreturn]] void fail(const std::string& reason) const {
    throw UserError(fmt::format("{}: {}", path_.string(), reason));
  }

 private:
  std::string_view bytes_;
  const std::filesystem::path& path_;
};

void put_camera(const slam::Camera& camera, ByteWriter& out) {
  out.put(static_cast<std::int32_t>(camera.lens));
  out.put(static_cast<std::int32_t>(camera.width));
  out.put(static_cast<std::int32_t>(camera.height));
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) out.put(value);
  for (const double value : camera.distortion) out.put(value);
  out.put(static_cast<std::uint8_t>(camera.guessed));
}

slam::Camera take_camera(ByteReader& in) {
  slam::Camera camera;
  const auto lens = in.number<std::int32_t>();
  if (lens != 0 && lens != 1) in.fail("names an unknown lens model");
  camera.lens = static_cast<slam::LensModel>(lens);
  camera.width = in.number<std::int32_t>();
  camera.height = in.number<std::int32_t>();
  for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy})
    *value = in.number<double>();
  for (double& value : camera.distortion) value = in.number<double>();
  camera.guessed = in.number<std::uint8_t>() != 0;
  if (camera.width <= 0 || camera.height <= 0 || !(camera.fx > 0.0) || !(camera.fy != 0.0)) {
    in.fail("has an impossible camera");
  }
  return camera;
}

void put_about(const Reconstruction& reconstruction, ByteWriter& out) {
  out.put(static_cast<std::uint8_t>(reconstruction.metric));
  out.put(reconstruction.median_depth);
  out.put(std::string_view(reconstruction.mode));
  out.put(std::string_view(reconstruction.segmentation));
  out.put(static_cast<std::uint64_t>(reconstruction.warnings.size()));
  for (const std::string& warning : reconstruction.warnings) out.put(std::string_view(warning));
}

void take_about(ByteReader& in, Reconstruction& reconstruction) {
  reconstruction.metric = in.number<std::uint8_t>() != 0;
  reconstruction.median_depth = in.number<double>();
  reconstruction.mode = in.text();
  reconstruction.segmentation = in.text();
  reconstruction.warnings.resize(in.count_of(sizeof(std::uint64_t)));
  for (std::string& warning : reconstruction.warnings) warning = in.text();
}

void put_chunk(std::string_view tag, const ByteWriter& payload, std::string& bytes) {
  ByteWriter size;
  size.put(static_cast<std::uint64_t>(payload.bytes().size()));
  bytes += tag;
  bytes += size.bytes();
  bytes += payload.bytes();
}

}  // namespace

void write_map_bin(const Reconstruction& reconstruction, const std::filesystem::path& path) {
  ByteWriter version;
  version.put(kVersion);
  std::string bytes = std::string(kMagic) + version.bytes();
  ByteWriter camera;
  put_camera(reconstruction.camera, camera);
  put_chunk("CAMR", camera, bytes);
  ByteWriter about;
  put_about(reconstruction, about);
  put_chunk("ABOU", about, bytes);
  write_file(path, bytes);
}

void read_map_bin(const std::filesystem::path& path, Reconstruction& reconstruction) {
  const std::string bytes = read_file(path);
  if (!std::string_view(bytes).starts_with(kMagic)) {
    throw UserError(fmt::format("{}: is not a map of this program", path.string()));
  }
  ByteReader file(std::string_view(bytes).substr(kMagic.size()), path);
  const auto version = file.number<std::uint32_t>();
  if (version != kVersion) file.fail(fmt::format("has version {}, not {}", version, kVersion));
  bool has_camera = false;
  while (!file.at_end()) {
    const std::string_view tag = file.take(4);
    ByteReader chunk(file.take(file.number<std::uint64_t>()), path);
    if (tag == "CAMR") {
      reconstruction.camera = take_camera(chunk);
      has_camera = true;
    } else if (tag == "ABOU") {
      take_about(chunk, reconstruction);
    }
  }
  if (!has_camera) file.fail("has no camera");
}

}  // namespace planecast::engine
