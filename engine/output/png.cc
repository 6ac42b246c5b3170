#include "engine/output/png.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "engine/output/atomic_file.h"
#include "engine/output/base64.h"
#include "engine/user_error.h"

namespace planecast::engine {

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
  return "data:image/png;base64," +
         base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string jpeg_data_uri(const cv::Mat& image, int quality) {
  std::vector<unsigned char> bytes;
  if (image.empty() || !cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
    return "data:,";
  }
  return "data:image/jpeg;base64," +
         base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace planecast::engine
