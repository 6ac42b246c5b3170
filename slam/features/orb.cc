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
  /// May reorder the corners.
  void describe(std::vector<cv::KeyPoint>& corners, std::vector<Descriptor>& descriptors) const;
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
  // Each level gets a share in proportion to its scale, as the area per corner then stays alike
  // [K].
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

void OrbExtractor::Impl::describe(std::vector<cv::KeyPoint>& corners,
                                  std::vector<Descriptor>& descriptors) const {
  if (corners.empty()) return;
  cv::Mat rows;
  descriptor->compute(pyramid.front(), corners, rows);
  descriptors.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    std::memcpy(descriptors[i].data(), rows.ptr<uchar>(static_cast<int>(i)), sizeof(Descriptor));
  }
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
  Features features;
  impl_->describe(corners, features.descriptors);
  features.keypoints.reserve(corners.size());
  for (const cv::KeyPoint& corner : corners) {
    Keypoint keypoint;
    keypoint.raw = {corner.pt.x, corner.pt.y};
    keypoint.pixel = camera.undistort(keypoint.raw.cast<double>()).cast<float>();
    keypoint.angle_deg = corner.angle;
    keypoint.response = corner.response;
    keypoint.octave = corner.octave;
    features.keypoints.push_back(keypoint);
  }
  features.build_grid(camera.width, camera.height);
  return features;
}

void OrbExtractor::set_image(const cv::Mat& grey) { impl_->build_pyramid(grey); }

std::vector<int> OrbExtractor::append(const std::vector<Keypoint>& points, Features& features) {
  const ScaleLevels& levels = impl_->options.levels;
  std::vector<cv::KeyPoint> corners;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto level = static_cast<std::size_t>(points[i].octave);
    if (level >= impl_->pyramid.size()) continue;
    const cv::Mat& image = impl_->pyramid[level];
    const auto scale = static_cast<float>(levels.scale(points[i].octave));
    cv::KeyPoint corner(points[i].raw.x() / scale, points[i].raw.y() / scale, 31.0F * scale);
    if (corner.pt.x < kBorder || corner.pt.y < kBorder ||
        corner.pt.x > static_cast<float>(image.cols - 1 - kBorder) ||
        corner.pt.y > static_cast<float>(image.rows - 1 - kBorder)) {
      continue;
    }
    corner.angle = orientation_deg(image, corner.pt, impl_->half_width);
    corner.pt *= scale;
    corner.octave = points[i].octave;
    corner.class_id = static_cast<int>(i);
    corners.push_back(corner);
  }
  std::vector<Descriptor> descriptors;
  impl_->describe(corners, descriptors);
  std::vector<int> indices(points.size(), -1);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const auto i = static_cast<std::size_t>(corners[c].class_id);
    indices[i] = features.size();
    features.keypoints.push_back(points[i]);
    features.keypoints.back().angle_deg = corners[c].angle;
    features.descriptors.push_back(descriptors[c]);
  }
  return indices;
}

}  // namespace planecast::slam
