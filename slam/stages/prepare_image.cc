#include "slam/stages/prepare_image.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "slam/features/pyramid.h"
#include "slam/stages/stopwatch.h"

namespace planecast::slam {

float depth_at(const cv::Mat& depth, const Eigen::Vector2f& raw, double max_depth_m) {
  const int x = static_cast<int>(std::lround(raw.x()));
  const int y = static_cast<int>(std::lround(raw.y()));
  if (x < 1 || y < 1 || x >= depth.cols - 1 || y >= depth.rows - 1) return 0.0F;
  const float centre = depth.at<float>(y, x);
  if (!(centre > 0.0F) || centre > static_cast<float>(max_depth_m)) return 0.0F;
  const float slack = 0.03F * centre;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const float other = depth.at<float>(y + dy, x + dx);
      if (other > 0.0F && std::abs(other - centre) > slack) return 0.0F;
    }
  }
  return centre;
}

bool ImageFeatures::moves_at(const Eigen::Vector2f& raw) const {
  const cv::Point pixel(static_cast<int>(std::lround(raw.x())),
                        static_cast<int>(std::lround(raw.y())));
  return !moving.empty() && cv::Rect(cv::Point(), moving.size()).contains(pixel) &&
         moving.at<uchar>(pixel) != 0;
}

ImagePreparer::ImagePreparer(const PrepareOptions& options, const Camera& camera)
    : options_(options), camera_(camera), extractor_(options.orb) {}

ImageFeatures ImagePreparer::read(const FrameInput& frame) const {
  Stopwatch watch;
  ImageFeatures image;
  image.frame_index = frame.index;
  image.timestamp = frame.timestamp;
  image.grey_or_bgr = frame.image;
  image.labels = frame.labels;
  if (options_.rgbd) image.depth = frame.depth;
  cv::Mat grey = frame.image;
  if (frame.image.channels() == 3) cv::cvtColor(frame.image, grey, cv::COLOR_BGR2GRAY);
  image.pyramid = std::make_shared<const ImagePyramid>(build_pyramid(grey));
  image.prepare_ms = watch.lap_ms();
  return image;
}

Features ImagePreparer::detect(const ImageFeatures& image, int limit) {
  Features features = extractor_.detect(image.pyramid->levels.front(), camera_, limit);
  if (!image.moving.empty()) {
    std::erase_if(features.keypoints, [&](const Keypoint& k) { return image.moves_at(k.raw); });
    features.build_grid(camera_.width, camera_.height);
  }
  return features;
}

void ImagePreparer::add_depth(const ImageFeatures& image, Features& features) const {
  if (image.depth.empty()) return;
  for (Keypoint& keypoint : features.keypoints) {
    keypoint.depth = depth_at(image.depth, keypoint.raw, options_.max_keypoint_depth_m);
  }
}

void ImagePreparer::extract(ImageFeatures& image, int limit) {
  Stopwatch watch;
  Features features = extractor_.extract(image.pyramid->levels.front(), camera_, limit);
  add_depth(image, features);
  image.features = std::make_shared<const Features>(std::move(features));
  image.prepare_ms += watch.lap_ms();
}

}  // namespace planecast::slam
