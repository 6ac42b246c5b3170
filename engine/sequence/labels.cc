#include "engine/sequence/labels.h"

#include <cstdint>
#include <map>

namespace planecast::engine {

namespace {

cv::Mat labels_from_colors(const cv::Mat& image) {
  cv::Mat labels(image.size(), CV_16U);
  std::map<std::uint32_t, std::uint16_t> label_of = {{0U, std::uint16_t{0}}};
  const int channels = image.channels();
  std::uint32_t last_color = 0;
  std::uint16_t last_label = 0;
  for (int y = 0; y < image.rows; ++y) {
    const auto* pixel = image.ptr<std::uint8_t>(y);
    auto* to = labels.ptr<std::uint16_t>(y);
    for (int x = 0; x < image.cols; ++x, pixel += channels) {
      const std::uint32_t color = pixel[0] | static_cast<std::uint32_t>(pixel[1]) << 8 |
                                  static_cast<std::uint32_t>(pixel[2]) << 16;
      if (color != last_color) {
        const auto next = static_cast<std::uint16_t>(label_of.size());
        last_label = label_of.try_emplace(color, next).first->second;
        last_color = color;
        if (label_of.size() > 65535) return {};  // a photograph, not a mask
      }
      to[x] = last_label;
    }
  }
  return labels;
}

}  // namespace

cv::Mat labels_from_image(const cv::Mat& image) {
  cv::Mat labels;
  switch (image.type()) {
    case CV_8UC1:
      image.convertTo(labels, CV_16U);
      return labels;
    case CV_16UC1:
      return image;
    case CV_8UC3:
    case CV_8UC4:
      return labels_from_colors(image);
    default:
      return {};
  }
}

}  // namespace planecast::engine
