#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

#include "slam/data/camera.h"

namespace planecast::slam {

/// Unit normal, towards the camera and in its frame, of the surface about a raw pixel: of the plane
/// in inverse depth (depth_blocks.h) through 5x5 pixels of a square of 2 radius_px + 1 a side.
/// `depth` is CV_32F, in units of which there are 1 / `metre` to a metre. Nothing at the border of
/// the image, where depth is missing, and where the square does not show one plane.
std::optional<Eigen::Vector3d> surface_normal(const cv::Mat& depth, const Camera& camera, int x,
                                              int y, int radius_px, double metre = 1.0);

}  // namespace planecast::slam
