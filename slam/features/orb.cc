#include "slam/features/orb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "slam/features/quad_tree.h"

namespace planecast::slam {
namespace {

constexpr int kPatchRadius = 15;
/// FAST itself needs 3 px, the orientation's patch 15, rounding 1.
constexpr int kBorder = 19;

/// Half width of each row of the orientation's disc.
std::array<int, kPatchRadius + 1> disc_half_widths() {
  std::array<int, kPatchRadius + 1> half_width{};
  for (int v = 0; v <= kPatchRadius; ++v) {
    half_width[static_cast<std::size_t>(v)] =
        static_cast<int>(std::sqrt(double(kPatchRadius * kPatchRadius - v * v)));
  }
  return half_width;
}

/// Angle of the intensity centroid in a disc (Rublee 2011, section 3.2), degrees in [0, 360).
float orientation_deg(const cv::Mat& image, const cv::Point2f& point,
                      const std::array<int, kPatchRadius + 1>& half_width) {
  const int x = cvRound(point.x);
  const int y = cvRound(point.y);
  int moment_x = 0;
  int moment_y = 0;
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const uchar* row = image.ptr<uchar>(y + v) + x;
    const int reach = half_width[static_cast<std::size_t>(std::abs(v))];
    int row_sum = 0;
    for (int u = -reach; u <= reach; ++u) {
      row_sum += row[u];
      moment_x += u * row[u];
    }
    moment_y += v * row_sum;
  }
  return cv::fastAtan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

/// In each cell the corners above `high`, or all where there is none of those.
std::vector<cv::KeyPoint> prefer_strong(const std::vector<cv::KeyPoint>& corners, int width,
                                        int height, int cell_px, int high) {
  const int columns = width / cell_px + 1;
  const int rows = height / cell_px + 1;
  const auto cell = [&](const cv::KeyPoint& corner) {
    return static_cast<std::size_t>(static_cast<int>(corner.pt.y) / cell_px * columns +
                                    static_cast<int>(corner.pt.x) / cell_px);
  };
  std::vector<char> has_strong(static_cast<std::size_t>(columns * rows), 0);
  for (const cv::KeyPoint& corner : corners) {
    if (corner.response >= static_cast<float>(high)) has_strong[cell(corner)] = 1;
  }
  std::vector<cv::KeyPoint> kept;
  kept.reserve(corners.size());
  for (const cv::KeyPoint& corner : corners) {
    if (corner.response >= static_cast<float>(high) || has_strong[cell(corner)] == 0) {
      kept.push_back(corner);
    }
  }
  return kept;
}

}  // namespace

struct OrbExtractor::Impl {
  OrbOptions options;
  cv::Ptr<cv::ORB> descriptor;
  std::array<int, kPatchRadius + 1> half_width = disc_half_widths();
  std::vector<cv::Mat> pyramid;

  void build_pyramid(const cv::Mat& grey);
  std::vector<cv::KeyPoint> detect(int level, int limit, int threshold) const;
  std::vector<cv::KeyPoint> detect_all(int limit, int threshold) const;
};

void OrbExtractor::Impl::build_pyramid(const cv::Mat& grey) {
  pyramid.assign(1, grey);
  for (int level = 1; level < options.levels.levels; ++level) {
    const double scale = options.levels.scale(level);
    const cv::Size size(cvRound(grey.cols / scale), cvRound(grey.rows / scale));
    if (std::min(size.width, size.height) <= 2 * kBorder + 1) break;
    cv::Mat image;
    cv::resize(pyramid.back(), image, size, 0, 0, cv::INTER_LINEAR);
    pyramid.push_back(image);
  }
}

std::vector<cv::KeyPoint> OrbExtractor::Impl::detect(int level, int limit, int threshold) const {
  const cv::Mat& image = pyramid[static_cast<std::size_t>(level)];
  const int inset = kBorder - 3;
  if (image.cols <= 2 * kBorder || image.rows <= 2 * kBorder) return {};
  const cv::Rect inner(inset, inset, image.cols - 2 * inset, image.rows - 2 * inset);
  std::vector<cv::KeyPoint> corners;
  cv::FAST(image(inner), corners, threshold, true);
  corners = prefer_strong(corners, inner.width, inner.height, options.cell_px,
                          std::max(threshold, options.fast_threshold));
  corners = spread_corners(corners, inner.width, inner.height, limit);
  const auto scale = static_cast<float>(options.levels.scale(level));
  for (cv::KeyPoint& corner : corners) {
    corner.pt += cv::Point2f(static_cast<float>(inset), static_cast<float>(inset));
    corner.angle = orientation_deg(image, corner.pt, half_width);
    corner.pt *= scale;
    corner.octave = level;
    corner.size = 31.0F * scale;
  }
  return corners;
}

std::vector<cv::KeyPoint> OrbExtractor::Impl::detect_all(int limit, int threshold) const {
  // Each level gets a share in proportion to its scale, as the area per corner then stays alike [K].
  const double ratio = 1.0 / options.levels.factor;
  const auto levels = static_cast<int>(pyramid.size());
  double share = limit * (1.0 - ratio) / (1.0 - std::pow(ratio, levels));
  std::vector<cv::KeyPoint> all;
  for (int level = 0; level < levels; ++level, share *= ratio) {
    const std::vector<cv::KeyPoint> corners =
        detect(level, std::max(1, static_cast<int>(std::lround(share))), threshold);
    all.insert(all.end(), corners.begin(), corners.end());
  }
  return all;
}

OrbExtractor::OrbExtractor(const OrbOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  // Only its descriptor is used; an edge threshold of 1 keeps our own border rule the only one.
  impl_->descriptor = cv::ORB::create(options.features, static_cast<float>(options.levels.factor),
                                      options.levels.levels, 1, 0, 2, cv::ORB::FAST_SCORE, 31);
}

OrbExtractor::~OrbExtractor() = default;

Features OrbExtractor::extract(const cv::Mat& grey, const Camera& camera, int limit) {
  const OrbOptions& options = impl_->options;
  if (limit == 0) limit = options.features;
  impl_->build_pyramid(grey);
  std::vector<cv::KeyPoint> corners = impl_->detect_all(limit, options.fast_threshold_low);
  if (static_cast<double>(corners.size()) < options.low_contrast_share * limit) {
    corners = impl_->detect_all(limit, options.fast_threshold_lowest);
  }
  cv::Mat descriptors;
  if (!corners.empty()) impl_->descriptor->compute(grey, corners, descriptors);

  Features features;
  features.keypoints.reserve(corners.size());
  features.descriptors.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Keypoint keypoint;
    keypoint.raw = {corners[i].pt.x, corners[i].pt.y};
    keypoint.pixel = camera.undistort(keypoint.raw.cast<double>()).cast<float>();
    keypoint.angle_deg = corners[i].angle;
    keypoint.response = corners[i].response;
    keypoint.octave = corners[i].octave;
    features.keypoints.push_back(keypoint);
    std::memcpy(features.descriptors[i].data(), descriptors.ptr<uchar>(static_cast<int>(i)),
                sizeof(Descriptor));
  }
  features.build_grid(camera.width, camera.height);
  return features;
}

}  // namespace planecast::slam
