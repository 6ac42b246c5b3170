#include "engine/output/ply.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>

#include "engine/output/atomic_file.h"
#include "engine/output/palette.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

static_assert(std::endian::native == std::endian::little,
              "points are dumped as they lie in memory");

constexpr std::string_view kHeaderBegin =
    "ply\nformat binary_little_endian 1.0\ncomment planecast map points\nelement vertex ";
constexpr std::string_view kHeaderEnd =
    "\nproperty double x\nproperty double y\nproperty double z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property int plane\n"
    "property float image_red\nproperty float image_green\nproperty float image_blue\n"
    "end_header\n";
constexpr std::size_t kVertexBytes =
    3 * sizeof(double) + 3 + sizeof(std::int32_t) + 3 * sizeof(float);

template <typename T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

template <typename T>
const char* take(const char* from, T* values, std::size_t count) {
  std::memcpy(values, from, count * sizeof(T));
  return from + count * sizeof(T);
}

}  // namespace

void write_ply(const std::vector<MapPoint>& points, const std::filesystem::path& path) {
  std::string bytes(kHeaderBegin);
  bytes += fmt::format("{}", points.size());
  bytes += kHeaderEnd;
  bytes.reserve(bytes.size() + points.size() * kVertexBytes);
  for (const MapPoint& point : points) {
    const Rgb color = plane_color(point.plane);
    const auto plane = static_cast<std::int32_t>(point.plane);
    append(bytes, point.position.data(), 3);
    append(bytes, color.data(), 3);
    append(bytes, &plane, 1);
    append(bytes, point.color_rgb.data(), 3);
  }
  write_file(path, bytes);
}

std::vector<MapPoint> read_ply(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const std::string_view view = bytes;
  const auto refuse = [&path](const char* reason) -> UserError {
    return UserError(fmt::format("{}: {}", path.string(), reason));
  };
  if (!view.starts_with(kHeaderBegin)) throw refuse("is not a point file of this program");
  std::size_t count = 0;
  const char* digits = bytes.data() + kHeaderBegin.size();
  const auto [end, error] = std::from_chars(digits, bytes.data() + bytes.size(), count);
  if (error != std::errc() || count > bytes.size()) throw refuse("has no valid number of points");
  const auto header_size = static_cast<std::size_t>(end - bytes.data()) + kHeaderEnd.size();
  if (!view.substr(static_cast<std::size_t>(end - bytes.data())).starts_with(kHeaderEnd)) {
    throw refuse("has another point layout than this program's");
  }
  if (bytes.size() != header_size + count * kVertexBytes) throw refuse("is truncated");

  std::vector<MapPoint> points(count);
  const char* from = bytes.data() + header_size;
  for (MapPoint& point : points) {
    Rgb plane_color_of_file{};
    std::int32_t plane = 0;
    from = take(from, point.position.data(), 3);
    from = take(from, plane_color_of_file.data(), 3);
    from = take(from, &plane, 1);
    from = take(from, point.color_rgb.data(), 3);
    point.plane = plane;
  }
  return points;
}

}  // namespace planecast::engine
