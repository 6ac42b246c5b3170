#include "slam/features/orb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "slam/data/vector_clones.h"
#include "slam/features/quad_tree.h"

namespace planecast::slam {
namespace {

constexpr int kPatchRadius = 15;
constexpr int kPatchSize = 2 * kPatchRadius + 1;
/// FAST itself needs 3 px, the orientation's patch 15, rounding 1.
constexpr int kBorder = 19;

/// Weights of an intensity centroid's moments over a disc, in rows of whole vectors: the last
/// column is 0.
struct Disc {
  static constexpr int kSide = 2 * kPatchRadius + 1;
  static constexpr int kColumns = kSide + 1;
  std::array<std::array<std::int16_t, kColumns>, kSide> inside{};  ///< 1 or 0
  std::array<std::array<std::int16_t, kColumns>, kSide> across{};  ///< the column, 0 outside
  Disc() {
    for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
      const auto row = static_cast<std::size_t>(v + kPatchRadius);
      const int reach = static_cast<int>(std::sqrt(double(kPatchRadius * kPatchRadius - v * v)));
      for (int u = -reach; u <= reach; ++u) {
        inside[row][static_cast<std::size_t>(u + kPatchRadius)] = 1;
        across[row][static_cast<std::size_t>(u + kPatchRadius)] = static_cast<std::int16_t>(u);
      }
    }
  }
};

/// Angle of the intensity centroid in the disc (Rublee 2011, section 3.2), degrees in [0, 360).
PLANECAST_VECTOR_CLONES
float orientation_deg(const cv::Mat& image, const cv::Point2f& point, const Disc& disc) {
  const int x = cvRound(point.x) - kPatchRadius;
  const int y = cvRound(point.y);
  int moment_x = 0;
  int moment_y = 0;
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const uchar* pixels = image.ptr<uchar>(y + v) + x;
    const auto row = static_cast<std::size_t>(v + kPatchRadius);
    const std::int16_t* inside = disc.inside[row].data();
    const std::int16_t* across = disc.across[row].data();
    int row_sum = 0;
    for (int u = 0; u < Disc::kColumns; ++u) {
      const auto grey = static_cast<std::int16_t>(pixels[u]);
      row_sum += grey * inside[u];
      moment_x += grey * across[u];
    }
    moment_y += v * row_sum;
  }
  return cv::fastAtan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

/// The cells of an image, row by row.
struct Cells {
  int columns;
  int rows;
  int side_px;

  Cells(const cv::Size& image, int side)
      : columns((image.width + side - 1) / side),
        rows((image.height + side - 1) / side),
        side_px(side) {}
  std::size_t at(const cv::Point2f& point) const {
    return static_cast<std::size_t>(static_cast<int>(point.y) / side_px * columns +
                                    static_cast<int>(point.x) / side_px);
  }
};

/// Corners above `low` in the cells begin..end of a row.
void detect_in_run(const cv::Mat& image, const Cells& cells, int row, int begin, int end, int low,
                   std::vector<cv::KeyPoint>& corners) {
  // FAST looks 3 px about a corner, and one corner beside it for the strongest.
  constexpr int kAround = 4;
  const cv::Rect inside = cv::Rect(begin * cells.side_px, row * cells.side_px,
                                   (end - begin) * cells.side_px, cells.side_px) &
                          cv::Rect({}, image.size());
  const cv::Rect reach = cv::Rect(inside.x - kAround, inside.y - kAround,
                                  inside.width + 2 * kAround, inside.height + 2 * kAround) &
                         cv::Rect({}, image.size());
  std::vector<cv::KeyPoint> found;
  cv::FAST(image(reach), found, low, true);
  for (cv::KeyPoint& corner : found) {
    corner.pt += cv::Point2f(static_cast<float>(reach.x), static_cast<float>(reach.y));
    if (inside.contains(cv::Point(corner.pt))) corners.push_back(corner);
  }
}

/// Corners above `high`; those above `low` in the cells that have none of these.
std::vector<cv::KeyPoint> detect_corners(const cv::Mat& image, int high, int low, int cell_px) {
  std::vector<cv::KeyPoint> corners;
  cv::FAST(image, corners, high, true);
  if (low >= high) return corners;
  const Cells cells(image.size(), cell_px);
  std::vector<char> has_strong(static_cast<std::size_t>(cells.columns * cells.rows), 0);
  for (const cv::KeyPoint& corner : corners) has_strong[cells.at(corner.pt)] = 1;
  for (int row = 0; row < cells.rows; ++row) {
    const auto strong = has_strong.begin() + static_cast<std::ptrdiff_t>(row * cells.columns);
    for (int begin = 0; begin < cells.columns;) {
      int end = begin;
      while (end < cells.columns && strong[end] == 0) ++end;
      if (end > begin) detect_in_run(image, cells, row, begin, end, low, corners);
      begin = end + 1;
    }
  }
  return corners;
}

}  // namespace

struct OrbExtractor::Impl {
  OrbOptions options;
  cv::Ptr<cv::ORB> descriptor;
  Disc disc;
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
  std::vector<cv::KeyPoint> corners =
      detect_corners(image(inner), options.fast_threshold, threshold, options.cell_px);
  corners = spread_corners(corners, inner.width, inner.height, limit);
  const auto scale = static_cast<float>(options.levels.scale(level));
  for (cv::KeyPoint& corner : corners) {
    corner.pt += cv::Point2f(static_cast<float>(inset), static_cast<float>(inset));
    corner.angle = orientation_deg(image, corner.pt, disc);
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

OrbExtractor::OrbExtractor(const OrbOptions& options) : impl_(std::make_unique<Impl>()) {
  impl_->options = options;
  // Only its descriptor is used, level by level on our own pyramid; an edge threshold of 1 keeps
  // our own border rule the only one.
  impl_->descriptor =
      cv::ORB::create(options.features, 2.0F, 1, 1, 0, 2, cv::ORB::FAST_SCORE, kPatchSize);
}

OrbExtractor::~OrbExtractor() = default;

Features OrbExtractor::extract(const cv::Mat& grey, const Camera& camera, int limit) {
  Features features = detect(grey, camera, limit);
  describe(features);
  return features;
}

Features OrbExtractor::detect(const cv::Mat& grey, const Camera& camera, int limit) {
  const OrbOptions& options = impl_->options;
  if (limit == 0) limit = options.features;
  impl_->build_pyramid(grey);
  std::vector<cv::KeyPoint> corners = impl_->detect_all(limit, options.fast_threshold_low);
  if (static_cast<double>(corners.size()) < options.low_contrast_share * limit) {
    corners = impl_->detect_all(limit, options.fast_threshold_lowest);
  }
  Features features;
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

void OrbExtractor::set_image(const cv::Mat& grey) {
  // The pyramid holds on to its image, so that the same place in memory is the same image.
  const bool known = !impl_->pyramid.empty() && impl_->pyramid.front().data == grey.data &&
                     impl_->pyramid.front().size() == grey.size();
  if (!known) impl_->build_pyramid(grey);
}

std::vector<int> OrbExtractor::append(const std::vector<Keypoint>& points, Features& features) {
  std::vector<int> indices(points.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto level = static_cast<std::size_t>(points[i].octave);
    if (level >= impl_->pyramid.size()) continue;
    const cv::Mat& image = impl_->pyramid[level];
    const auto scale = static_cast<float>(impl_->options.levels.scale(points[i].octave));
    const cv::Point2f at_level(points[i].raw.x() / scale, points[i].raw.y() / scale);
    if (at_level.x < kBorder || at_level.y < kBorder ||
        at_level.x > static_cast<float>(image.cols - 1 - kBorder) ||
        at_level.y > static_cast<float>(image.rows - 1 - kBorder)) {
      continue;
    }
    indices[i] = features.size();
    features.keypoints.push_back(points[i]);
    features.keypoints.back().angle_deg = orientation_deg(image, at_level, impl_->disc);
  }
  return indices;
}

void OrbExtractor::describe(Features& features) const {
  const auto described = static_cast<int>(features.descriptors.size());
  features.descriptors.resize(features.keypoints.size());
  std::vector<std::vector<cv::KeyPoint>> corners(impl_->pyramid.size());
  for (int k = described; k < features.size(); ++k) {
    const Keypoint& keypoint = features.keypoints[static_cast<std::size_t>(k)];
    const auto scale = static_cast<float>(impl_->options.levels.scale(keypoint.octave));
    corners[static_cast<std::size_t>(keypoint.octave)].emplace_back(
        keypoint.raw.x() / scale, keypoint.raw.y() / scale, static_cast<float>(kPatchSize),
        keypoint.angle_deg, keypoint.response, 0, k);
  }
  for (std::size_t level = 0; level < corners.size(); ++level) {
    if (corners[level].empty()) continue;
    cv::Mat rows;
    impl_->descriptor->compute(impl_->pyramid[level], corners[level], rows);
    for (std::size_t i = 0; i < corners[level].size(); ++i) {
      const auto k = static_cast<std::size_t>(corners[level][i].class_id);
      std::memcpy(features.descriptors[k].data(), rows.ptr<uchar>(static_cast<int>(i)),
                  sizeof(Descriptor));
    }
  }
}

}  // namespace planecast::slam
