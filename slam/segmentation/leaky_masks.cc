#include "slam/segmentation/leaky_masks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "slam/geometry/random.h"

namespace planecast::slam {

namespace {

using Pixels = std::vector<cv::Point>;

/// Pixels of each instance, by label.
std::map<int, Pixels> instances_of(const cv::Mat& labels) {
  std::map<int, Pixels> result;
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const int label = labels.at<ushort>(y, x);
      if (label > 0) result[label].emplace_back(x, y);
    }
  }
  return result;
}

bool is_on_border(const cv::Mat& labels, const cv::Point& p) {
  if (p.x == 0 || p.y == 0 || p.x == labels.cols - 1 || p.y == labels.rows - 1) return false;
  const ushort label = labels.at<ushort>(p);
  return labels.at<ushort>(p.y, p.x - 1) != label || labels.at<ushort>(p.y, p.x + 1) != label ||
         labels.at<ushort>(p.y - 1, p.x) != label || labels.at<ushort>(p.y + 1, p.x) != label;
}

class LeakySegmenter : public PlaneSegmenter {
 public:
  LeakySegmenter(std::unique_ptr<PlaneSegmenter> inner, double share, std::uint64_t seed)
      : inner_(std::move(inner)), share_(share), seed_(seed) {}

  cv::Mat segment(const FrameInput& frame) override {
    const cv::Mat labels = inner_->segment(frame);
    if (labels.empty() || !(share_ > 0.0)) return labels;
    Random random(mix_seed(seed_, static_cast<std::uint64_t>(frame.index)));
    cv::Mat leaky = labels.clone();
    cv::Mat taken = cv::Mat::zeros(labels.size(), CV_8U);
    for (const auto& [label, pixels] : instances_of(labels)) {
      leak(labels, label, pixels, random, leaky, taken);
    }
    return leaky;
  }

  std::string name() const override {
    return inner_->name() + ", " + std::to_string(std::lround(100.0 * share_)) + " % leaked";
  }

 private:
  void leak(const cv::Mat& labels, int label, const Pixels& pixels, Random& random, cv::Mat& leaky,
            cv::Mat& taken) const {
    Pixels border;
    std::copy_if(pixels.begin(), pixels.end(), std::back_inserter(border),
                 [&](const cv::Point& p) { return is_on_border(labels, p); });
    if (border.empty()) return;
    const cv::Point centre = border[random.below(static_cast<int>(border.size()))];
    std::vector<std::pair<int, int>> foreign;  // (squared distance, place)
    for (int y = 0; y < labels.rows; ++y) {
      for (int x = 0; x < labels.cols; ++x) {
        if (labels.at<ushort>(y, x) == label || taken.at<uchar>(y, x) != 0) continue;
        const int dx = x - centre.x;
        const int dy = y - centre.y;
        foreign.emplace_back(dx * dx + dy * dy, y * labels.cols + x);
      }
    }
    const double wanted = share_ / (1.0 - share_) * static_cast<double>(pixels.size());
    const std::size_t count = std::min(foreign.size(), static_cast<std::size_t>(wanted));
    std::nth_element(foreign.begin(), foreign.begin() + static_cast<std::ptrdiff_t>(count),
                     foreign.end());
    for (std::size_t i = 0; i < count; ++i) {
      const cv::Point p(foreign[i].second % labels.cols, foreign[i].second / labels.cols);
      leaky.at<ushort>(p) = static_cast<ushort>(label);
      taken.at<uchar>(p) = 1;
    }
  }

  std::unique_ptr<PlaneSegmenter> inner_;
  double share_;
  std::uint64_t seed_;
};

}  // namespace

std::unique_ptr<PlaneSegmenter> make_leaky_segmenter(std::unique_ptr<PlaneSegmenter> inner,
                                                     double share, std::uint64_t seed) {
  return std::make_unique<LeakySegmenter>(std::move(inner), share, seed);
}

}  // namespace planecast::slam
