#include "engine/sequence/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

extern "C" {
#include <libavutil/log.h>
}

#include "engine/sequence/image_check.h"
#include "engine/sequence/jpeg_file.h"
#include "engine/sequence/labels.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

std::vector<std::uint8_t> read_bytes(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw UserError(file.string() + ": no such file");
  if (!fs::is_regular_file(file, error)) throw UserError(file.string() + ": not a file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw UserError(file.string() + ": cannot be opened");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error || size > kMaxImageBytes) {
    throw UserError(file.string() + ": the file is too large for a picture");
  }
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

cv::Mat decode(const fs::path& file, int flags) {
  const std::vector<std::uint8_t> bytes = read_bytes(file);
  const ImageCheck check = check_image_file(bytes);
  // The decoders would take any kind by its content, some without a bound of its size.
  if (!check.known) throw UserError(file.string() + ": is no PNG, JPEG, BMP or TIFF picture");
  check_image_size(file, check.width, check.height);
  if (!check.damage.empty()) throw UserError(fmt::format("{}: {}", file.string(), check.damage));
  cv::Mat image;
  try {
    if (flags == cv::IMREAD_COLOR) image = decode_common_jpeg(bytes);
    if (image.empty()) image = cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw UserError(file.string() + ": cannot be decoded as an image");
  check_image_size(file, image.cols, image.rows);
  return image;
}

void no_message(void*, int, const char*, va_list) {}

}  // namespace

void check_image_size(const fs::path& file, int width, int height) {
  if (std::max(width, height) > kMaxImageSide) {
    throw UserError(fmt::format("{}: {}x{} pixels are more than {} a side", file.string(), width,
                                height, kMaxImageSide));
  }
  if (static_cast<long long>(width) * height > kMaxImagePixels) {
    throw UserError(fmt::format("{}: {}x{} pixels are more than {}", file.string(), width, height,
                                kMaxImagePixels));
  }
}

bool has_image_suffix(const fs::path& file) {
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix == ".png" || suffix == ".jpg" || suffix == ".jpeg" || suffix == ".bmp" ||
         suffix == ".tif" || suffix == ".tiff";
}

cv::Mat read_color_image(const fs::path& file) { return decode(file, cv::IMREAD_COLOR); }

cv::Mat read_depth_image(const fs::path& file, double depth_factor) {
  const cv::Mat raw = decode(file, cv::IMREAD_UNCHANGED);
  if (raw.type() != CV_16UC1)
    throw UserError(file.string() + ": depth must be a 16-bit grey image");
  cv::Mat depth_m(raw.size(), CV_32F);
  const double metres_per_unit = 1.0 / depth_factor;
  for (int y = 0; y < raw.rows; ++y) {
    const auto* from = raw.ptr<std::uint16_t>(y);
    auto* to = depth_m.ptr<float>(y);
    for (int x = 0; x < raw.cols; ++x) {
      to[x] = from[x] == 65535 ? 0.0F : static_cast<float>(from[x] * metres_per_unit);
    }
  }
  return depth_m;
}

cv::Mat read_label_image(const fs::path& file) {
  const cv::Mat labels = labels_from_image(decode(file, cv::IMREAD_UNCHANGED));
  if (labels.empty()) {
    throw UserError(file.string() + ": a mask must be an 8- or 16-bit grey or 24-bit colour image");
  }
  return labels;
}

void silence_codecs() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  av_log_set_callback(no_message);
}

}  // namespace planecast::engine
