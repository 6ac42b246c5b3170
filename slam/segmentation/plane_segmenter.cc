#include "slam/segmentation/plane_segmenter.h"

#include <cmath>

namespace planecast::slam {

namespace {

class MaskSegmenter : public PlaneSegmenter {
 public:
  cv::Mat segment(const FrameInput& frame) override {
    if (frame.labels.empty() || frame.labels.size() != frame.image.size()) return {};
    if (frame.labels.type() == CV_16U) return frame.labels;
    cv::Mat labels;
    if (frame.labels.channels() == 1) frame.labels.convertTo(labels, CV_16U);
    return labels;
  }
  std::string name() const override { return "masks 1"; }
};

class NoSegmenter : public PlaneSegmenter {
 public:
  cv::Mat segment(const FrameInput&) override { return {}; }
  std::string name() const override { return "none"; }
};

}  // namespace

std::unique_ptr<PlaneSegmenter> make_mask_segmenter() { return std::make_unique<MaskSegmenter>(); }
std::unique_ptr<PlaneSegmenter> make_no_segmenter() { return std::make_unique<NoSegmenter>(); }

int label_at(const cv::Mat& labels, const Eigen::Vector2f& raw_pixel) {
  const int x = static_cast<int>(std::lround(raw_pixel.x()));
  const int y = static_cast<int>(std::lround(raw_pixel.y()));
  if (labels.empty() || x < 1 || y < 1 || x >= labels.cols - 1 || y >= labels.rows - 1) return 0;
  const ushort label = labels.at<ushort>(y, x);
  for (int row = y - 1; row <= y + 1; ++row) {
    const ushort* line = labels.ptr<ushort>(row);
    for (int col = x - 1; col <= x + 1; ++col) {
      if (line[col] != label) return 0;
    }
  }
  return label;
}

}  // namespace planecast::slam
