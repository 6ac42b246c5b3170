#pragma once

#include <opencv2/core.hpp>

#include "engine/look/object_layer.h"
#include "slam/data/camera.h"

namespace planecast::engine {

/// Draws the object layer through the lens instead of undistorting the video: the layer is rendered
/// by an ideal pinhole that covers the undistorted picture, then resampled to raw pixels. The
/// picture itself is never resampled. Without distortion nothing is done and nothing is allocated.
class LensWarp {
 public:
  /// Lenses that see farther than the layer may grow (`max_growth` times each side) lose the rest.
  explicit LensWarp(const slam::Camera& camera, double max_growth = 2.0);

  bool needed() const { return needed_; }
  /// The pinhole to render with: same focal lengths, moved centre, larger picture, no distortion.
  const slam::Camera& layer_camera() const { return layer_camera_; }
  /// Colours bilinear, which keeps them premultiplied; depth nearest.
  ObjectLayer to_raw(const ObjectLayer& layer) const;
  /// A raw depth image (CV_32F, 0 = unknown) as the layer's camera sees it, nearest neighbour.
  cv::Mat depth_to_layer(const cv::Mat& raw_depth) const;

 private:
  cv::Rect raw_bounds(const cv::Rect& layer_bounds) const;

  slam::Camera camera_;
  slam::Camera layer_camera_;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();  ///< layer pixel - undistorted pixel
  bool needed_ = false;
  cv::Mat layer_from_raw_;  ///< CV_32FC2: layer pixel of each raw pixel
  cv::Mat raw_from_layer_;  ///< CV_32FC2: raw pixel of each layer pixel
};

}  // namespace planecast::engine
