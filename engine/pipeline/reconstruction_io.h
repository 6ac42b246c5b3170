#pragma once

#include <filesystem>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Writes a reconstruction folder: trajectory.txt, trajectory_causal.txt, keyframes.txt,
/// planes.json, map.ply, map.bin, scene.glb, frames.csv, times.csv, timings.json, summary.json.
/// Each file is written under a temporary name and renamed; map.bin comes last, so that a folder
/// with it is complete. All but times.csv, timings.json and map.bin (which hold times) are the same
/// bytes for the same input. Throws UserError where a file cannot be written.
void write_reconstruction(const Reconstruction& reconstruction,
                          const std::filesystem::path& folder);

/// Reads the folder back. The readable files are the truth for what they hold (an edited
/// planes.json counts): frames from frames.csv, poses from the three trajectories (matched to
/// frames by their exact time), planes and up from planes.json, points from map.ply, the rest from
/// map.bin. Throws UserError with one line naming the missing or broken file.
Reconstruction read_reconstruction(const std::filesystem::path& folder);

}  // namespace planecast::engine
