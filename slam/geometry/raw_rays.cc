#include "slam/geometry/raw_rays.h"

namespace planecast::slam {

cv::Mat raw_rays(const Camera& camera) {
  cv::Mat rays(camera.height, camera.width, CV_32FC2);
  for (int y = 0; y < rays.rows; ++y) {
    for (int x = 0; x < rays.cols; ++x) {
      const Eigen::Vector2d raw(x, y);
      const Eigen::Vector3d ray = camera.ray(camera.has_distortion() ? camera.undistort(raw) : raw);
      rays.at<cv::Vec2f>(y, x) = {static_cast<float>(ray.x()), static_cast<float>(ray.y())};
    }
  }
  return rays;
}

}  // namespace planecast::slam
