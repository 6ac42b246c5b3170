#include "slam/stages/stereo_depth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <future>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "slam/features/rectified_pair.h"
#include "slam/geometry/raw_rays.h"

namespace planecast::slam {

namespace {

/// By the keyframe's landmarks; what is nearer than most of them is looked for as well.
std::optional<double> nearest_depth(const Map& map, const Keyframe& keyframe) {
  constexpr std::size_t kFewest = 10;
  constexpr double kNearer = 0.6;
  std::vector<double> depths = map.landmark_depths(keyframe.id);
  std::erase_if(depths, [](double z) { return !(z > 0.0); });
  if (depths.size() < kFewest) return std::nullopt;
  const auto nearest = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 50);
  std::nth_element(depths.begin(), nearest, depths.end());
  return kNearer * *nearest;
}

Camera reduced(const Camera& camera, int most_width) {
  const int width = std::min(most_width, camera.width);
  const double height = static_cast<double>(camera.height) * width / camera.width;
  return camera.scaled_to(width, static_cast<int>(std::lround(height)));
}

/// A keyframe that sees the same as another from beside it.
struct Beside {
  const Keyframe* keyframe = nullptr;
  Eigen::Vector3d shift;  ///< in the other's frame, in its median depths
  double cost = 0.0;
};

std::vector<Beside> all_beside(const Map& map, const Keyframe& own, double median,
                               const StereoDepthOptions& options) {
  std::vector<Beside> result;
  for (const Keyframe& other : map.keyframes) {
    if (other.id == own.id || other.pyramid == nullptr) continue;
    const Pose own_from_other = own.cam_from_world * other.cam_from_world.inverse();
    const Eigen::Vector3d shift = own_from_other.translation() / median;
    const double baseline = shift.norm();
    if (baseline < options.min_baseline || baseline > options.max_baseline) continue;
    const Eigen::Vector3d view = own_from_other.linear().col(2);
    if (view.z() < options.min_view_cosine) continue;
    const Eigen::Vector3d between = (view + Eigen::Vector3d::UnitZ()).normalized();
    const double forward = std::abs(between.dot(shift)) / baseline;
    if (forward > options.max_forward) continue;
    result.push_back(
        {&other, shift, std::abs(std::log(baseline / options.best_baseline)) + forward});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Beside& a, const Beside& b) { return a.cost < b.cost; });
  return result;
}

/// CV_16S, sixteenths of a pixel, negative where nothing was found. The penalties are a quarter of
/// what is usual: with those, the steps of a stair become a slope.
cv::Mat match(const cv::Mat& left, const cv::Mat& right, int disparities) {
  constexpr int kBlock = 5;
  constexpr int kPenaltyOne = 2 * kBlock * kBlock;
  constexpr int kPenaltyMore = 4 * kPenaltyOne;
  constexpr int kLeftRight = 1;
  constexpr int kUniqueness = 10;
  constexpr int kSpeckle = 60;
  constexpr int kSpeckleRange = 1;
  const auto matcher =
      cv::StereoSGBM::create(0, disparities, kBlock, kPenaltyOne, kPenaltyMore, kLeftRight, 0,
                             kUniqueness, kSpeckle, kSpeckleRange, cv::StereoSGBM::MODE_SGBM);
  cv::Mat disparity;
  matcher->compute(left, right, disparity);
  return disparity;
}

/// Between four pixels, in pixels; nothing where one of them is unknown or they are not of one
/// surface.
std::optional<double> disparity_at(const cv::Mat& disparity, double x, double y) {
  constexpr int kUnit = cv::StereoMatcher::DISP_SCALE;
  constexpr int kLeast = kUnit;
  constexpr int kOneSurface = 3 * kUnit / 2;
  const int col = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  if (col < 0 || row < 0 || col + 1 >= disparity.cols || row + 1 >= disparity.rows) return {};
  const auto* above = disparity.ptr<std::int16_t>(row) + col;
  const auto* below = disparity.ptr<std::int16_t>(row + 1) + col;
  const auto [low, high] = std::minmax({above[0], above[1], below[0], below[1]});
  if (low < kLeast || high - low > kOneSurface) return {};
  const double a = x - col;
  const double b = y - row;
  return ((1.0 - b) * ((1.0 - a) * above[0] + a * above[1]) +
          b * ((1.0 - a) * below[0] + a * below[1])) /
         kUnit;
}

}  // namespace

std::vector<const Keyframe*> keyframes_beside(const Map& map, const Keyframe& own,
                                              const StereoDepthOptions& options) {
  std::vector<Beside> taken;
  std::vector<const Keyframe*> result;
  const double median = map.median_depth(own.id);
  if (!(median > 0.0)) return result;
  for (const Beside& one : all_beside(map, own, median, options)) {
    const bool apart = std::all_of(taken.begin(), taken.end(), [&](const Beside& other) {
      return (one.shift - other.shift).norm() > 0.5 * options.best_baseline;
    });
    if (!apart) continue;
    taken.push_back(one);
    result.push_back(one.keyframe);
    if (static_cast<int>(result.size()) == options.pairs) break;
  }
  return result;
}

StereoDepth::StereoDepth(const Camera& camera, const StereoDepthOptions& options)
    : camera_(camera), options_(options), rays_(raw_rays(reduced(camera, options.width))) {}

cv::Mat StereoDepth::of(const Map& map, KeyframeId id) const {
  const Keyframe& own = map.keyframes.at(id);
  const auto nearest = nearest_depth(map, own);
  if (own.pyramid == nullptr || !nearest) return {};
  const std::vector<const Keyframe*> others = keyframes_beside(map, own, options_);
  std::vector<cv::Mat> inverse_depths(others.size());
  const auto compare_some = [&](std::size_t first) {
    const auto step = static_cast<std::size_t>(options_.threads);
    for (std::size_t i = first; i < others.size(); i += step) {
      inverse_depths[i] = compare(own, *others[i], *nearest);
    }
  };
  std::vector<std::future<void>> helpers;
  for (int k = 1; k < std::min(options_.threads, static_cast<int>(others.size())); ++k) {
    helpers.push_back(std::async(std::launch::async, compare_some, static_cast<std::size_t>(k)));
  }
  compare_some(0);
  for (std::future<void>& helper : helpers) helper.get();
  std::erase_if(inverse_depths, [](const cv::Mat& one) { return one.empty(); });
  if (inverse_depths.size() < 2) return {};
  cv::Mat depth;
  cv::resize(agreed(inverse_depths), depth, {camera_.width, camera_.height}, 0, 0,
             cv::INTER_NEAREST);
  return depth;
}

cv::Mat StereoDepth::compare(const Keyframe& left, const Keyframe& right, double nearest) const {
  const auto pair =
      rectify_pair(left.cam_from_world * right.cam_from_world.inverse(), camera_, rays_, nearest);
  if (!pair) return {};
  cv::Mat seen_left, seen_right;
  const cv::Mat left_image =
      rectify_image(*left.pyramid, camera_, *pair, pair->rect_from_left, seen_left);
  const cv::Mat right_image =
      rectify_image(*right.pyramid, camera_, *pair, pair->rect_from_right, seen_right);
  const cv::Mat disparity = match(left_image, right_image, pair->margin);
  cv::Mat result = cv::Mat::zeros(rays_.size(), CV_32F);
  for (int row = 0; row < rays_.rows; ++row) {
    for (int col = 0; col < rays_.cols; ++col) {
      const auto& ray = rays_.at<cv::Vec2f>(row, col);
      const Eigen::Vector3d turned = pair->rect_from_left * Eigen::Vector3d(ray[0], ray[1], 1.0);
      const Eigen::Vector2d at = pair->focal / turned.z() * turned.head<2>() - pair->first;
      const auto shift = disparity_at(disparity, at.x(), at.y());
      if (!shift) continue;
      const auto right_col = static_cast<int>(std::lround(at.x() - *shift));
      const auto right_row = static_cast<int>(std::lround(at.y()));
      if (right_col < 0 || seen_right.at<std::uint8_t>(right_row, right_col) == 0) continue;
      result.at<float>(row, col) =
          static_cast<float>(*shift * turned.z() / (pair->focal * pair->baseline));
    }
  }
  return result;
}

cv::Mat StereoDepth::agreed(const std::vector<cv::Mat>& inverse_depths) const {
  cv::Mat depth = cv::Mat::zeros(rays_.size(), CV_32F);
  std::vector<float> known;
  for (int row = 0; row < depth.rows; ++row) {
    for (int col = 0; col < depth.cols; ++col) {
      known.clear();
      for (const cv::Mat& one : inverse_depths) {
        if (one.at<float>(row, col) > 0.0F) known.push_back(one.at<float>(row, col));
      }
      std::sort(known.begin(), known.end());
      // The mean of the two that are most alike.
      float least = static_cast<float>(options_.max_disagreement);
      for (std::size_t i = 1; i < known.size(); ++i) {
        const float mean = 0.5F * (known[i - 1] + known[i]);
        const float apart = (known[i] - known[i - 1]) / mean;
        if (apart > least) continue;
        least = apart;
        depth.at<float>(row, col) = 1.0F / mean;
      }
    }
  }
  return depth;
}

}  // namespace planecast::slam
