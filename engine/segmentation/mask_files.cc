#include "engine/segmentation/mask_files.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "engine/output/atomic_file.h"
#include "engine/output/palette.h"
#include "engine/output/png.h"
#include "engine/output/trajectory.h"

namespace planecast::engine {

cv::Mat paint_masks(const cv::Mat& image, const cv::Mat& labels) {
  constexpr double kPaint = 0.45;
  cv::Mat painted;
  if (image.channels() == 1) {
    cv::cvtColor(image, painted, cv::COLOR_GRAY2BGR);
  } else {
    painted = image.clone();
  }
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const int label = labels.at<ushort>(y, x);
      const bool edge = (x + 1 < labels.cols && labels.at<ushort>(y, x + 1) != label) ||
                        (y + 1 < labels.rows && labels.at<ushort>(y + 1, x) != label);
      auto& pixel = painted.at<cv::Vec3b>(y, x);
      if (edge) {
        pixel = {255, 255, 255};
      } else if (label > 0) {
        const Rgb color = plane_color(label);
        for (int c = 0; c < 3; ++c) {
          pixel[c] = cv::saturate_cast<uchar>((1.0 - kPaint) * pixel[c] +
                                              kPaint * color[static_cast<std::size_t>(2 - c)]);
        }
      }
    }
  }
  return painted;
}

MaskFolder::MaskFolder(std::filesystem::path folder, std::string segmenter, bool overlays)
    : folder_(std::move(folder)), segmenter_(std::move(segmenter)), overlays_(overlays) {
  make_folder(folder_ / "mask");
  if (overlays_) make_folder(folder_ / "overlay");
}

void MaskFolder::add(int index, double timestamp, const cv::Mat& image, const cv::Mat& labels) {
  cv::Mat mask = labels.empty() ? cv::Mat::zeros(image.size(), CV_16U) : labels;
  if (overlays_) {
    write_png(paint_masks(image, mask), folder_ / fmt::format("overlay/{:06d}.png", index));
  }
  std::set<ushort> instances(mask.begin<ushort>(), mask.end<ushort>());
  instances.erase(0);
  double most = 0.0;
  cv::minMaxLoc(mask, nullptr, &most);
  if (most < 256.0) mask.convertTo(mask, CV_8U);
  const std::string name = fmt::format("mask/{:06d}.png", index);
  write_png(mask, folder_ / name);
  masks_.push_back({index, timestamp, name, static_cast<int>(instances.size())});
}

std::filesystem::path MaskFolder::finish() const {
  std::string list = "# plane instance masks by " + segmenter_ + "\n# timestamp filename\n";
  for (const MaskRecord& mask : masks_) {
    list += format_timestamp(mask.timestamp) + " " + mask.file + "\n";
  }
  write_file(folder_ / "mask.txt", list);
  return folder_ / "mask.txt";
}

}  // namespace planecast::engine
