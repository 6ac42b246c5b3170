#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "engine/pipeline/reconstruction.h"
#include "engine/sequence/sequence.h"

namespace planecast::engine {

struct TrackSequenceOptions {
  std::string mode = "auto";          ///< mono | rgbd | auto (rgbd where there is depth)
  std::string segmentation = "auto";  ///< see engine/segmentation/choose_segmenter.h
  std::string network;                ///< ONNX file for the segmentation; empty: our own
  bool causal = false;                ///< no second pass
  int threads = 2;                    ///< changes no result
  std::uint64_t seed = 1;
  bool skip_unreadable = false;
  double mask_leakage = 0.0;  ///< share of each mask that is made to be of others, for measurements
  std::optional<Eigen::Vector3d> up;    ///< unit, world; estimated where not given
  std::string plane_merge = "default";  ///< default | paper
  std::string plane_fit = "graph-cut";  ///< graph-cut | plain: sequential RANSAC alone
  bool map_planes = true;
  bool refine_jointly = true;  ///< final refinement of points, poses and planes together
  int features = 1000;
  bool close_loops = true;
  std::string map;  ///< reconstruction folder to go on from; empty: start anew
};

/// Reconstruction::stopped of a run that was asked to end (engine/cancel.h).
inline constexpr const char* kInterrupted = "interrupted";

/// Called with (done, total) after each frame of either pass.
using Progress = std::function<void(int done, int total)>;

/// SLAM over the whole sequence; then, unless causal, every frame is localised against the finished
/// map. With an earlier map the sequence is localised in it, mapping goes on from there, and the
/// world and its units are the map's; keyframes and frames of the result are those of the sequence
/// alone. A frame that cannot be read (without skip_unreadable) ends the sequence before it, and a
/// request to cancel ends the work after the frame it is at: `stopped` tells. Throws UserError for
/// bad options, a map that cannot be used, and where not even the first frame can be read.
Reconstruction track_sequence(Sequence& sequence, const TrackSequenceOptions& options,
                              const Progress& progress);

bool was_interrupted(const Reconstruction& reconstruction);
/// Throws what ended the run before the sequence did: Cancelled, or UserError for the frame that
/// could not be read.
void require_complete(const Reconstruction& reconstruction);

}  // namespace planecast::engine
