#pragma once

#include <optional>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Where content was put: a ray of the camera at a frame.
struct Tap {
  int frame_index = 0;
  Eigen::Vector3d direction_cam = Eigen::Vector3d::UnitZ();
};

/// The pose of a frame as it was known after each change of the map in the first pass: up to the
/// frame its causal pose, from then on carried along by the last keyframe before it. Nothing where
/// it cannot be told.
std::vector<std::optional<slam::Pose>> frame_poses_by_change(const Reconstruction& reconstruction,
                                                             int frame_index);

/// A young monocular map knows directions well and depths badly: what was tapped lies on the tap's
/// ray still when the map has found out how far. Shifts the plane's own frame in its plane
/// (`world_from_plane` by change of the map) so that what stands on the tapped point stays where
/// the ray meets the plane as both are known by then.
void follow_tap(const Reconstruction& reconstruction, const Tap& tap,
                std::vector<std::optional<slam::Pose>>& world_from_plane);

}  // namespace planecast::engine
