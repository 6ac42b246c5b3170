#include "engine/output/png.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

std::string base64(const std::vector<unsigned char>& bytes) {
  static constexpr char kAlphabet[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned triple = 0;
    for (std::size_t k = 0; k < 3; ++k) triple = triple << 8 | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kAlphabet[triple >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace

void write_png(const cv::Mat& image, const std::filesystem::path& path, int compression) {
  std::vector<unsigned char> bytes;
  if (image.empty() ||
      !cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, compression})) {
    throw UserError(fmt::format("{}: cannot encode the image as PNG", path.string()));
  }
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string png_data_uri(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  if (image.empty() || !cv::imencode(".png", image, bytes)) return "data:,";
  return "data:image/png;base64," + base64(bytes);
}

std::string jpeg_data_uri(const cv::Mat& image, int quality) {
  std::vector<unsigned char> bytes;
  if (image.empty() || !cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
    return "data:,";
  }
  return "data:image/jpeg;base64," + base64(bytes);
}

}  // namespace planecast::engine
