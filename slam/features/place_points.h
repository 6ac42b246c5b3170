#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/features/orb.h"

namespace planecast::slam {

/// A point of an image that was found by its looks, not by the detector.
struct FoundPoint {
  Eigen::Vector2f raw;
  Eigen::Vector2d pixel;  ///< undistorted
  int octave = 0;         ///< at which it is expected
};

/// Gives each point a keypoint: the nearest free one within `snap_px` (at its octave), moved to the
/// point's precise position, or else a new one. `taken` (per keypoint) marks those that are not
/// free and grows along. The image must be the extractor's last. Returns the keypoint of each
/// point, -1 for one too near to the border; builds the grid anew. New keypoints have no descriptor
/// yet.
std::vector<int> place_points(const std::vector<FoundPoint>& points, const Camera& camera,
                              double snap_px, const ScaleLevels& levels, OrbExtractor& extractor,
                              std::vector<char>& taken, Features& features);

}  // namespace planecast::slam
