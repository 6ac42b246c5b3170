#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// A pinhole without distortion that two cameras are turned into: what the left one sees at column
/// c, the right one sees in the same row at c - focal baseline / z.
struct RectifiedPair {
  Eigen::Matrix3d rect_from_left;
  Eigen::Matrix3d rect_from_right;
  double focal = 0.0;     ///< pixels
  double baseline = 0.0;  ///< map units
  Eigen::Vector2d first;  ///< the first pixel, from the optical axis
  cv::Size size;
  int margin = 0;  ///< columns at the left that only the right camera fills, a multiple of 16
};

/// The pair for two views of one camera that has `rays` (raw_rays). It shows the whole of the left
/// image, in pixels as large, and its margin is the shift at depth `nearest`, 256 at most. Nothing
/// where an image would be stretched to more than 1.6 times its longer side: the cameras look along
/// the line between them.
std::optional<RectifiedPair> rectify_pair(const Pose& left_from_right, const Camera& camera,
                                          const cv::Mat& rays, double nearest);

/// An image as the pair's pinhole sees it, turned by `rect_from_cam`, by the level whose pixels are
/// the largest that are not larger; `seen`, CV_8U, is 255 where it shows anything.
cv::Mat rectify_image(const ImagePyramid& image, const Camera& camera, const RectifiedPair& pair,
                      const Eigen::Matrix3d& rect_from_cam, cv::Mat& seen);

}  // namespace planecast::slam
