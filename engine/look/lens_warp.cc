#include "engine/look/lens_warp.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace planecast::engine {
namespace {

/// Undistorted bounds of the picture's border, limited to the given growth of each side.
Eigen::AlignedBox2d undistorted_bounds(const slam::Camera& camera, double max_growth) {
  Eigen::AlignedBox2d box;
  constexpr int kSteps = 64;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = (camera.width - 1) * static_cast<double>(i) / kSteps;
    const double y = (camera.height - 1) * static_cast<double>(i) / kSteps;
    box.extend(camera.undistort({x, 0.0}));
    box.extend(camera.undistort({x, camera.height - 1.0}));
    box.extend(camera.undistort({0.0, y}));
    box.extend(camera.undistort({camera.width - 1.0, y}));
  }
  const Eigen::Vector2d size(camera.width, camera.height);
  const Eigen::Vector2d margin = 0.5 * (max_growth - 1.0) * size;
  return box.intersection(
      Eigen::AlignedBox2d(Eigen::Vector2d(-margin), Eigen::Vector2d(size + margin)));
}

template <typename Function>
cv::Mat pixel_map(int width, int height, const Function& function) {
  cv::Mat map(height, width, CV_32FC2);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Eigen::Vector2f pixel = function(Eigen::Vector2d(x, y)).template cast<float>();
      map.at<cv::Point2f>(y, x) = {pixel.x(), pixel.y()};
    }
  }
  return map;
}

}  // namespace

LensWarp::LensWarp(const slam::Camera& camera, double max_growth)
    : camera_(camera), layer_camera_(camera), needed_(camera.has_distortion()) {
  if (!needed_) return;
  const Eigen::AlignedBox2d box = undistorted_bounds(camera, max_growth);
  offset_ = -box.min().array().floor().matrix();
  const Eigen::Vector2d size =
      (box.max() + offset_).array().ceil().matrix() + Eigen::Vector2d::Ones();
  layer_camera_.lens = slam::LensModel::kPinhole;
  layer_camera_.distortion.fill(0.0);
  layer_camera_.width = static_cast<int>(size.x());
  layer_camera_.height = static_cast<int>(size.y());
  layer_camera_.cx += offset_.x();
  layer_camera_.cy += offset_.y();
  layer_from_raw_ = pixel_map(camera.width, camera.height, [this](const Eigen::Vector2d& raw) {
    return Eigen::Vector2d(camera_.undistort(raw) + offset_);
  });
  raw_from_layer_ =
      pixel_map(layer_camera_.width, layer_camera_.height,
                [this](const Eigen::Vector2d& pixel) { return camera_.distort(pixel - offset_); });
}

cv::Rect LensWarp::raw_bounds(const cv::Rect& layer_bounds) const {
  Eigen::AlignedBox2d box;
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = layer_bounds.x + layer_bounds.width * static_cast<double>(i) / kSteps;
    const double y = layer_bounds.y + layer_bounds.height * static_cast<double>(i) / kSteps;
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(x, layer_bounds.y), Eigen::Vector2d(x, layer_bounds.br().y),
          Eigen::Vector2d(layer_bounds.x, y), Eigen::Vector2d(layer_bounds.br().x, y)}) {
      box.extend(camera_.distort(corner - offset_));
    }
  }
  // The border samples miss at most the sagitta of an arc between two of them, under a pixel.
  constexpr int kMargin = 3;
  const cv::Point from(static_cast<int>(std::floor(box.min().x())) - kMargin,
                       static_cast<int>(std::floor(box.min().y())) - kMargin);
  const cv::Point to(static_cast<int>(std::ceil(box.max().x())) + kMargin,
                     static_cast<int>(std::ceil(box.max().y())) + kMargin);
  return cv::Rect(from, to) & cv::Rect(0, 0, camera_.width, camera_.height);
}

ObjectLayer LensWarp::to_raw(const ObjectLayer& layer) const {
  if (!needed_) return layer;
  ObjectLayer raw;
  raw.rgba = cv::Mat::zeros(camera_.height, camera_.width, CV_8UC4);
  raw.depth = cv::Mat::zeros(camera_.height, camera_.width, CV_32FC1);
  if (layer.bounds.empty()) return raw;
  raw.bounds = raw_bounds(layer.bounds);
  if (raw.bounds.empty()) return raw;
  const cv::Mat map = layer_from_raw_(raw.bounds);
  cv::Mat rgba = raw.rgba(raw.bounds);
  cv::remap(layer.rgba, rgba, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  if (!layer.depth.empty()) {
    cv::Mat depth = raw.depth(raw.bounds);
    cv::remap(layer.depth, depth, map, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  }
  return raw;
}

cv::Mat LensWarp::depth_to_layer(const cv::Mat& raw_depth) const {
  if (!needed_) return raw_depth;
  cv::Mat depth;
  cv::remap(raw_depth, depth, raw_from_layer_, cv::noArray(), cv::INTER_NEAREST,
            cv::BORDER_CONSTANT);
  return depth;
}

}  // namespace planecast::engine
