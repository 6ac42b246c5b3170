#include "slam/features/rectified_pair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "slam/features/pyramid.h"
#include "slam/geometry/lens.h"

namespace planecast::slam {

namespace {

/// Bounds of the left image on the pinhole's plane, in pixels from its axis.
struct Bounds {
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::max());
  Eigen::Array2d high = -low;
};

std::optional<Bounds> bounds_of(const cv::Mat& rays, const Eigen::Matrix3d& rect_from_cam,
                                double focal) {
  constexpr double kLeastZ = 0.1;
  constexpr int kStep = 4;
  Bounds bounds;
  for (int row = 0; row < rays.rows; row += kStep) {
    for (int col = 0; col < rays.cols; col += kStep) {
      const auto& ray = rays.at<cv::Vec2f>(row, col);
      const Eigen::Vector3d turned = rect_from_cam * Eigen::Vector3d(ray[0], ray[1], 1.0);
      if (turned.z() < kLeastZ) return std::nullopt;
      const Eigen::Array2d at = focal / turned.z() * turned.head<2>().array();
      bounds.low = bounds.low.min(at);
      bounds.high = bounds.high.max(at);
    }
  }
  return bounds;
}

}  // namespace

std::optional<RectifiedPair> rectify_pair(const Pose& left_from_right, const Camera& camera,
                                          const cv::Mat& rays, double nearest) {
  constexpr double kMostStretched = 1.6;
  constexpr double kMostShift = 256.0;
  constexpr int kMarginStep = 16;
  RectifiedPair pair;
  pair.focal = std::abs(camera.fx) * rays.cols / camera.width;
  pair.baseline = left_from_right.translation().norm();
  // Along the rows from left to right, and as nearly as that leaves it the way both look.
  const Eigen::Vector3d x = left_from_right.translation() / pair.baseline;
  const Eigen::Vector3d view = left_from_right.linear().col(2) + Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d z = (view - view.dot(x) * x).normalized();
  pair.rect_from_left << x.transpose(), z.cross(x).transpose(), z.transpose();
  pair.rect_from_right = pair.rect_from_left * left_from_right.linear();
  const auto bounds = bounds_of(rays, pair.rect_from_left, pair.focal);
  if (!bounds) return std::nullopt;
  const Eigen::Array2d extent = bounds->high - bounds->low;
  if (extent.maxCoeff() > kMostStretched * std::max(rays.cols, rays.rows)) return std::nullopt;
  const double shift = std::min(pair.focal * pair.baseline / nearest, kMostShift);
  pair.margin = kMarginStep * static_cast<int>(std::ceil(shift / kMarginStep));
  pair.first = {std::floor(bounds->low.x()) - pair.margin, std::floor(bounds->low.y())};
  pair.size = {static_cast<int>(extent.x()) + pair.margin + 2, static_cast<int>(extent.y()) + 2};
  return pair;
}

cv::Mat rectify_image(const ImagePyramid& image, const Camera& camera, const RectifiedPair& pair,
                      const Eigen::Matrix3d& rect_from_cam, cv::Mat& seen) {
  const double reduction = std::abs(camera.fx) / pair.focal;
  const int level = std::clamp(static_cast<int>(std::floor(std::log2(reduction) + 1e-6)), 0,
                               static_cast<int>(image.levels.size()) - 1);
  const cv::Mat& source = image.levels[static_cast<std::size_t>(level)];
  cv::Mat places(pair.size, CV_32FC2);
  seen.create(pair.size, CV_8U);
  const Eigen::Matrix3d cam_from_rect = rect_from_cam.transpose();
  const auto right = static_cast<float>(source.cols - 1);
  const auto bottom = static_cast<float>(source.rows - 1);
  for (int row = 0; row < places.rows; ++row) {
    auto* place = places.ptr<cv::Vec2f>(row);
    auto* mark = seen.ptr<std::uint8_t>(row);
    Eigen::Vector3d ray =
        cam_from_rect * Eigen::Vector3d(pair.first.x(), pair.first.y() + row, pair.focal);
    for (int col = 0; col < places.cols; ++col, ray += cam_from_rect.col(0)) {
      Eigen::Vector2f at(-1.0F, -1.0F);
      if (ray.z() > 0.0) at = at_level(project_raw(camera, ray).cast<float>(), level);
      place[col] = {at.x(), at.y()};
      const bool inside = at.x() >= 0.0F && at.y() >= 0.0F && at.x() <= right && at.y() <= bottom;
      mark[col] = inside ? 255 : 0;
    }
  }
  cv::Mat result;
  cv::remap(source, result, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

}  // namespace planecast::slam
