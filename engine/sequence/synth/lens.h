#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "slam/data/camera.h"

namespace planecast::engine::synth {

/// Lenses of the generator: "none" (an ideal pinhole, 63 degrees wide) and "wide" (81 degrees with
/// the barrel distortion of a small machine vision lens).
std::vector<std::string> lens_names();
/// Throws std::invalid_argument for a name that is none of them.
slam::Camera lens_camera(const std::string& name, int width, int height);

/// What a distorting camera sees, made from the picture of a wider pinhole.
class LensWarp {
 public:
  explicit LensWarp(const slam::Camera& camera);

  /// The pinhole that is to be drawn: covers the camera's whole field at the resolution of its
  /// middle. The camera itself where it has no distortion.
  const slam::Camera& drawn_camera() const { return drawn_; }
  /// Colours: bilinear.
  cv::Mat warp_colors(const cv::Mat& drawn) const;
  /// Depth and labels: the nearest pixel.
  cv::Mat warp_nearest(const cv::Mat& drawn) const;

 private:
  slam::Camera drawn_;
  cv::Mat source_px_;  ///< CV_32FC2: where each pixel is in the drawn picture; empty: no distortion
};

}  // namespace planecast::engine::synth
