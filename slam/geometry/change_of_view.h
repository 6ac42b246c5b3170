#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// How the surroundings of a point look from elsewhere: derivative of its raw pixel in another
/// image by its raw pixel in the reference. The surface through `point_ref` (reference camera
/// frame) has the normal `normal_ref`. Nothing where it is seen edge-on or from behind.
std::optional<Eigen::Matrix2d> change_of_view(const Camera& camera,
                                              const Eigen::Vector3d& point_ref,
                                              const Eigen::Vector3d& normal_ref,
                                              const Pose& cam_from_ref);

}  // namespace planecast::slam
