#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/data/types.h"

namespace planecast::slam {

struct AlignFrameOptions {
  /// Ends at the first level whose shorter side is not above this; precise positions are found
  /// afterwards, point by point.
  int finest_side_px = 180;
  int iterations = 10;        ///< a level
  double converged_px = 0.1;  ///< of its level: largest mean movement of the points
  int min_points = 12;
};

/// Sparse image alignment (Forster, Pizzoli, Scaramuzza 2014, section IV.A): the pose at which the
/// surroundings of known points look as they did in the frame before, coarse to fine, by the
/// inverse compositional method with one gain and offset for the image and a robust weight for each
/// point. `points_before`: in the camera frame of `before`. `guess`: cam_from_before. Nothing with
/// too few points or where it runs away.
std::optional<Pose> align_frame(const Camera& camera, const ImagePyramid& before,
                                const std::vector<Eigen::Vector3d>& points_before,
                                const ImagePyramid& image, const Pose& guess_cam_from_before,
                                const AlignFrameOptions& options = {});

}  // namespace planecast::slam
