#pragma once

#include <filesystem>
#include <vector>

#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// Reads a trajectory in TUM format: lines `timestamp tx ty tz qx qy qz qw`, world from camera,
/// '#' begins a comment. The quaternion is normalised. Throws UserError naming file and line for a
/// line that is not eight finite numbers or whose quaternion is zero.
std::vector<TimedPose> read_trajectory(const std::filesystem::path& file);

}  // namespace planecast::engine
