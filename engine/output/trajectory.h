#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// Seconds with 6 decimals, or with as many digits as reading back exactly takes.
std::string format_timestamp(double seconds);

/// TUM text format, one pose a line: `timestamp tx ty tz qx qy qz qw`, world from camera, 12
/// decimals (reading back is exact to 1e-11 of a unit), the quaternion with qw >= 0.
std::string trajectory_text(const std::vector<TimedPose>& poses);

/// Throws UserError.
void write_trajectory(const std::vector<TimedPose>& poses, const std::filesystem::path& path);

}  // namespace planecast::engine
