#pragma once

#include <Eigen/Geometry>

namespace planecast::slam {

/// Rigid transform. Named target_from_source: `cam_from_world * p_world = p_cam`.
using Pose = Eigen::Isometry3d;

/// Ids are dense, start at 0 and are never used again; kNone stands for "no such thing".
using KeyframeId = int;
using LandmarkId = int;
using PlaneId = int;
inline constexpr int kNone = -1;

}  // namespace planecast::slam
