#include "engine/channels.h"

#include <opencv2/imgproc.hpp>

namespace planecast::engine {

cv::Mat to_grey(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

cv::Mat to_bgr(const cv::Mat& image) {
  if (image.channels() == 3) return image.clone();
  cv::Mat bgr;
  cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

}  // namespace planecast::engine
