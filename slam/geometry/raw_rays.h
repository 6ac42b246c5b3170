#pragma once

#include <opencv2/core.hpp>

#include "slam/data/camera.h"

namespace planecast::slam {

/// Undistorted rays (x, y, 1), without the 1, of the camera's raw pixels: CV_32FC2.
cv::Mat raw_rays(const Camera& camera);

}  // namespace planecast::slam
