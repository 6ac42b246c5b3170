#pragma once

#include <opencv2/core.hpp>

namespace planecast::engine {

/// Grey picture (8-bit, one channel) of one in grey or BGR. A grey one is returned as it is:
/// shared, not copied.
cv::Mat to_grey(const cv::Mat& image);

/// BGR picture of one in grey or BGR, always a copy of its own.
cv::Mat to_bgr(const cv::Mat& image);

}  // namespace planecast::engine
