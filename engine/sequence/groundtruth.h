#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// Reads a trajectory in TUM format: lines `timestamp tx ty tz qx qy qz qw`, world from camera,
/// '#' begins a comment. The quaternion is normalised. Throws UserError naming file and line for a
/// line that is not eight finite numbers or whose quaternion is zero.
std::vector<TimedPose> read_trajectory(const std::filesystem::path& file);

/// Where the true poses of a sequence are: groundtruth.txt (TUM), *.gt.freiburg (ICL-NUIM),
/// state_groundtruth_estimate0/data.csv (EuRoC), or the folder itself where it holds *.pose.txt
/// (7-Scenes). Nothing if it has none.
std::optional<std::filesystem::path> find_groundtruth(const std::filesystem::path& sequence);

/// Reads true poses in the format of any of these, or of the folder that holds one of them; world
/// from camera, in the order of time.
/// - ICL-NUIM numbers its poses like its frames: times are number / fps.
/// - EuRoC gives the body's pose in nanoseconds: turned into cam0's by T_BS of cam0/sensor.yaml.
/// - 7-Scenes has a 4x4 matrix a frame; frames whose matrix is not finite are left out.
/// Throws UserError naming the file (and line) that is missing or malformed.
std::vector<TimedPose> read_groundtruth(const std::filesystem::path& file_or_folder,
                                        double fps = 30.0);

}  // namespace planecast::engine
