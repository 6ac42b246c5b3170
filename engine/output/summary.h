#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Counts of a run, without times of computing: repeatable.
struct Summary {
  int frames = 0;
  int tracked = 0;    ///< with a pose when the frame came (causal)
  int localised = 0;  ///< with a final pose
  int lost = 0;
  int unreadable = 0;
  int first_tracked_frame = -1;      ///< index; -1 = never
  int frames_until_initialised = 0;  ///< frames before the first causal pose; all of them if none
  int keyframes = 0;
  int planes = 0;
  int points = 0;
  int points_on_planes = 0;
  double mean_inliers = 0.0;                       ///< of frames with a final pose
  std::map<std::string, int> not_tracked_because;  ///< reason -> frames, of the first pass
  double path_length = 0.0;  ///< of the final camera positions, map units or metres
};

Summary summarise(const Reconstruction& reconstruction);

/// summary.json: mode, segmentation, units, camera, the counts above, planes by class, warnings;
/// `stopped` where it ends before the sequence does, with the reason.
nlohmann::ordered_json summary_json(const Reconstruction& reconstruction);
void write_summary(const Reconstruction& reconstruction, const std::filesystem::path& path);
/// The part of it that no other file holds; nothing where there is none. Throws UserError.
std::optional<PlaneRms> read_plane_rms(const std::filesystem::path& path);

}  // namespace planecast::engine
