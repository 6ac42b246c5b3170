#include "engine/sequence/synth/lens.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace planecast::engine::synth {
namespace {

cv::Mat remap(const cv::Mat& image, const cv::Mat& source_px, int interpolation) {
  if (source_px.empty()) return image;
  cv::Mat warped;
  cv::remap(image, warped, source_px, cv::noArray(), interpolation, cv::BORDER_REPLICATE);
  return warped;
}

}  // namespace

std::vector<std::string> lens_names() { return {"none", "wide"}; }

slam::Camera lens_camera(const std::string& name, int width, int height) {
  slam::Camera camera;
  camera.width = width;
  camera.height = height;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  if (name == "none") {
    camera.fx = camera.fy = 525.0 * width / 640.0;
  } else if (name == "wide") {
    camera.fx = camera.fy = 375.0 * width / 640.0;
    camera.distortion = {-0.28, 0.07, 0.0002, 0.0001, 0.0};
  } else {
    throw std::invalid_argument(name + ": no such lens");
  }
  return camera;
}

LensWarp::LensWarp(const slam::Camera& camera) : drawn_(camera) {
  if (!camera.has_distortion()) return;
  constexpr int kBorder_px = 2;
  source_px_.create(camera.height, camera.width, CV_32FC2);
  double half_width = 0.0;
  double half_height = 0.0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d pixel = camera.undistort(Eigen::Vector2d(x, y));
      half_width = std::max(half_width, std::abs(pixel.x() - camera.cx));
      half_height = std::max(half_height, std::abs(pixel.y() - camera.cy));
      source_px_.at<cv::Vec2f>(y, x) = {static_cast<float>(pixel.x() - camera.cx),
                                        static_cast<float>(pixel.y() - camera.cy)};
    }
  }
  drawn_.distortion = {0, 0, 0, 0, 0};
  drawn_.width = 2 * (static_cast<int>(std::ceil(half_width)) + kBorder_px);
  drawn_.height = 2 * (static_cast<int>(std::ceil(half_height)) + kBorder_px);
  drawn_.cx = 0.5 * (drawn_.width - 1);
  drawn_.cy = 0.5 * (drawn_.height - 1);
  source_px_ += cv::Scalar(drawn_.cx, drawn_.cy);
}

cv::Mat LensWarp::warp_colors(const cv::Mat& drawn) const {
  return remap(drawn, source_px_, cv::INTER_LINEAR);
}

cv::Mat LensWarp::warp_nearest(const cv::Mat& drawn) const {
  return remap(drawn, source_px_, cv::INTER_NEAREST);
}

}  // namespace planecast::engine::synth
