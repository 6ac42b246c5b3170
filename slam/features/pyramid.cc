#include "slam/features/pyramid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace planecast::slam {

ImagePyramid build_pyramid(const cv::Mat& grey, int max_levels, int min_side_px) {
  ImagePyramid pyramid;
  pyramid.levels.push_back(grey);
  while (static_cast<int>(pyramid.levels.size()) < max_levels) {
    const cv::Mat& finer = pyramid.levels.back();
    const cv::Size size(finer.cols / 2, finer.rows / 2);
    if (std::min(size.width, size.height) < min_side_px) break;
    // An odd last row or column is left out, so that the mean is always that of 2 x 2 pixels.
    cv::Mat coarser;
    cv::resize(finer(cv::Rect(0, 0, 2 * size.width, 2 * size.height)), coarser, size, 0, 0,
               cv::INTER_AREA);
    pyramid.levels.push_back(coarser);
  }
  return pyramid;
}

}  // namespace planecast::slam
