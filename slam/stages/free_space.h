#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::slam {

/// How much further a keyframe must have seen than a place for the place to have been empty.
struct DepthMargin {
  double relative = 0.0;  ///< of the place's depth
  double metres = 0.0;
};

struct FreeSpaceOptions {
  int block_px = 8;  ///< at 640 px image width
  DepthMargin certain{0.1, 0.05};
  DepthMargin likely{0.03, 0.02};  ///< enough beside what is certain
  int neighbours = 10;             ///< keyframes that are asked
};

/// The least depth of each block of raw pixels, CV_32F metres; 0 where nothing was measured.
cv::Mat nearest_depths(const cv::Mat& depth, const FreeSpaceOptions& options);

/// Where something moves: CV_8U of the size of `depth`, 255 in the blocks of raw pixels whose place
/// was empty when one of `keyframes` (those with Keyframe::nearest_depth) saw through it, and in
/// those about them where it was likely empty. What came there may go on: neither landmarks nor
/// planes should be built on it. Edges get the benefit of the doubt. Empty where nothing moves.
cv::Mat moving_parts(const cv::Mat& depth, const Pose& cam_from_world, const Map& map,
                     const std::vector<KeyframeId>& keyframes, const Camera& camera,
                     const FreeSpaceOptions& options);

}  // namespace planecast::slam
