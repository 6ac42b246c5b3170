#include "engine/look/depth_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace planecast::engine {
namespace {

/// Pixels whose 3x3 neighbourhood spans two surfaces or a surface and a hole.
cv::Mat jumps(const cv::Mat& depth, double step_share) {
  cv::Mat known = depth > 0.0F;
  cv::Mat far_for_unknown = depth.clone();
  far_for_unknown.setTo(1e9F, ~known);
  cv::Mat nearest;
  cv::Mat farthest;
  cv::erode(far_for_unknown, nearest, cv::Mat());
  cv::dilate(depth, farthest, cv::Mat());
  cv::Mat all_known;
  cv::erode(known, all_known, cv::Mat());
  cv::Mat jump = farthest > nearest * (1.0 + step_share);
  jump.setTo(0, farthest <= 0.0F);
  const cv::Mat hole_edge = ~all_known & (farthest > 0.0F);
  return jump | hole_edge;
}

/// exp(-d^2 / 2 sigma^2) by the difference of two 8-bit values.
std::array<float, 256> likeness_table(double sigma) {
  std::array<float, 256> table{};
  for (int d = 0; d < 256; ++d) {
    table[static_cast<std::size_t>(d)] =
        static_cast<float>(std::exp(-0.5 * d * d / (sigma * sigma)));
  }
  return table;
}

class EdgeVote {
 public:
  EdgeVote(const cv::Mat& depth, const cv::Mat& image, const DepthEdgeOptions& options)
      : depth_(depth),
        image_(image),
        options_(options),
        likeness_(likeness_table(options.color_sigma)) {
    const double spread = 0.5 * options.window_px;
    for (int d = 0; d <= options.window_px; ++d) {
      nearness_.push_back(static_cast<float>(std::exp(-0.5 * d * d / (spread * spread))));
    }
  }

  float at(int y, int x) const {
    const int r = options_.window_px;
    const cv::Rect window =
        cv::Rect(x - r, y - r, 2 * r + 1, 2 * r + 1) & cv::Rect(cv::Point(), depth_.size());
    // The window's extremes name the two surfaces; what lies halfway parts them.
    float nearest = 1e9F;
    float farthest = 0.0F;
    for (int v = window.y; v < window.br().y; v += options_.grid_px) {
      const auto* row = depth_.ptr<float>(v);
      for (int u = window.x; u < window.br().x; u += options_.grid_px) {
        if (row[u] <= 0.0F) continue;
        nearest = std::min(nearest, row[u]);
        farthest = std::max(farthest, row[u]);
      }
    }
    if (farthest <= 0.0F) return depth_.at<float>(y, x);
    const float between = std::sqrt(nearest * farthest);
    const bool two = farthest > nearest * static_cast<float>(1.0 + options_.step_share);
    std::array<float, 2> weight{};
    std::array<float, 2> sum{};
    for (int v = window.y; v < window.br().y; v += options_.grid_px) {
      const auto* row = depth_.ptr<float>(v);
      for (int u = window.x; u < window.br().x; u += options_.grid_px) {
        if (row[u] <= 0.0F) continue;
        const std::size_t side = two && row[u] > between ? 1 : 0;
        const float w = alike(y, x, v, u) * nearness_[static_cast<std::size_t>(std::abs(v - y))] *
                        nearness_[static_cast<std::size_t>(std::abs(u - x))];
        weight[side] += w;
        sum[side] += w * row[u];
      }
    }
    const std::size_t winner = weight[1] > weight[0] ? 1 : 0;
    return weight[winner] > 0.0F ? sum[winner] / weight[winner] : depth_.at<float>(y, x);
  }

 private:
  float alike(int y, int x, int v, int u) const {
    if (image_.channels() == 1) {
      return likeness(image_.at<std::uint8_t>(y, x), image_.at<std::uint8_t>(v, u));
    }
    const cv::Vec3b& a = image_.at<cv::Vec3b>(y, x);
    const cv::Vec3b& b = image_.at<cv::Vec3b>(v, u);
    return likeness(a[0], b[0]) * likeness(a[1], b[1]) * likeness(a[2], b[2]);
  }
  float likeness(int a, int b) const {
    return likeness_[static_cast<std::size_t>(std::abs(a - b))];
  }

  const cv::Mat& depth_;
  const cv::Mat& image_;
  const DepthEdgeOptions& options_;
  std::array<float, 256> likeness_;
  std::vector<float> nearness_;
};

/// Votes on the band inside `region`; `depth` is read, `refined` written.
void refine_region(const cv::Mat& depth, const cv::Mat& image, const cv::Rect& region,
                   const DepthEdgeOptions& options, cv::Mat& refined) {
  const cv::Rect whole(cv::Point(), depth.size());
  const cv::Rect inside = region & whole;
  if (inside.empty()) return;
  const int reach = options.band_px + options.window_px;
  const cv::Rect around = cv::Rect(inside.x - reach, inside.y - reach, inside.width + 2 * reach,
                                   inside.height + 2 * reach) &
                          whole;
  // A copy, for filters of a part look beyond it.
  const cv::Mat part = depth(around).clone();
  cv::Mat band;
  const int side = 2 * options.band_px + 1;
  cv::dilate(jumps(part, options.step_share), band, cv::Mat::ones(side, side, CV_8UC1));
  // The picture's noise must not vote.
  cv::Mat calm;
  cv::GaussianBlur(image(around), calm, cv::Size(3, 3), 0.8);
  const EdgeVote vote(part, calm, options);
  for (int y = inside.y; y < inside.br().y; ++y) {
    for (int x = inside.x; x < inside.br().x; ++x) {
      const cv::Point at(x - around.x, y - around.y);
      if (band.at<std::uint8_t>(at) != 0) refined.at<float>(y, x) = vote.at(at.y, at.x);
    }
  }
}

}  // namespace

cv::Mat refine_depth_edges(const cv::Mat& depth, const cv::Mat& image,
                           const std::vector<cv::Rect>& regions, const DepthEdgeOptions& options) {
  cv::Mat calm;
  cv::medianBlur(depth, calm, 5);
  cv::Mat refined = calm.clone();
  for (const cv::Rect& region : regions) refine_region(calm, image, region, options, refined);
  return refined;
}

}  // namespace planecast::engine
