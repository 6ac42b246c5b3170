#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace planecast::slam {

/// Chooses about `limit` of the corners so that they spread over the image: the area is split into
/// quarters, fullest first, until there are as many cells as wanted; each cell keeps its strongest
/// corner. Ties go to the earlier corner. The result keeps the order of the cells' creation.
std::vector<cv::KeyPoint> spread_corners(const std::vector<cv::KeyPoint>& corners, int width,
                                         int height, int limit);

}  // namespace planecast::slam
