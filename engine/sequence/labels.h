#pragma once

#include <opencv2/core.hpp>

namespace planecast::engine {

/// Instance labels of a mask picture as CV_16U, 0 = none: 8- and 16-bit grey values are the labels;
/// colours (a fourth channel is ignored) are numbered 1, 2, ... in the order in which they first
/// appear in this picture, row by row, and black is 0. An empty matrix for any other kind.
cv::Mat labels_from_image(const cv::Mat& image);

}  // namespace planecast::engine
