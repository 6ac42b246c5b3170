#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

#include "engine/channels.h"

namespace planecast::bench {

/// Milliseconds of a clock that never goes back.
inline double wall_ms() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

/// Milliseconds of processor time of all threads, in which a busy machine counts less.
inline double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Cost {
  double wall_ms = 0.0;
  double cpu_ms = 0.0;  ///< of all threads
};

/// What every figure is compared with: cv::ORB::detectAndCompute of 1000 features. Callers set
/// OpenCV's threads to one.
class OrbCall {
 public:
  /// Cost of one call on a picture in grey or BGR; the change to grey is not counted.
  Cost measure(const cv::Mat& image) {
    const cv::Mat grey = engine::to_grey(image);
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    const double wall = wall_ms();
    const double cpu = cpu_ms();
    orb_->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
    return {wall_ms() - wall, cpu_ms() - cpu};
  }

 private:
  cv::Ptr<cv::ORB> orb_ = cv::ORB::create(1000);
};

/// The value below which `share` of the values lie; 0 of none.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace planecast::bench
