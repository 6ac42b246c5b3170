#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/evaluate/planes.h"

namespace planecast::engine {

struct OverlayOptions {
  PlaneEvaluationOptions planes;  ///< alignment, and which estimate stands for which true plane
  int grid_cells = 7;             ///< of the grid laid over each true patch
  bool causal = false;            ///< judge poses and planes as they were known at their frames
  int ease_frames = 8;            ///< causal: as the scene file's `ease`
};

/// Error of drawn content in pixels: drawn with estimated pose and map minus drawn with the truth.
struct DriftFigures {
  Statistics drift_px;   ///< rms and p95 are the headline
  Statistics jitter_px;  ///< |second difference| of a grid point's error over consecutive frames
};

struct FrameDrift {
  int frame_index = 0;
  int points = 0;
  double aligned_rms_px = 0.0;
  double tapped_rms_px = 0.0;
};

/// Two ways to anchor the same grid in the estimated map:
/// `aligned`: the true grid brought over by the alignment of the trajectories and dropped onto the
/// estimated plane: includes every error of scale, pose and plane;
/// `tapped`: hit-tested in the first frame that sees the point, as a user places content: zero
/// there, and from then on what a viewer sees slide. Independent of the alignment and of the map's
/// scale. Only points where the hit test finds this plane count: where the map knows no surface, or
/// another one in front, nobody can place anything.
/// Both are then held in the plane's own frame, as anchors are; causal, the plane is where it was
/// known at each frame (PlaneMotion), and nothing is drawn before it was known.
struct OverlayResult {
  int planes = 0;  ///< matched, each carrying a grid
  int frames = 0;  ///< in which any grid point was visible
  DriftFigures aligned;
  DriftFigures tapped;
  std::vector<FrameDrift> per_frame;
};

/// A grid point counts in a frame where the truth shows it from the plane's front inside the image
/// (occlusion is not considered). `true_camera` projects the truth, the reconstruction's own camera
/// the estimate. Nothing if the trajectories share fewer than 3 poses; no plane that matches gives
/// planes = 0 and empty figures.
std::optional<OverlayResult> evaluate_overlay(const Reconstruction& estimate,
                                              const std::vector<PlaneRecord>& truth,
                                              const std::vector<TimedPose>& truth_poses,
                                              const slam::Camera& true_camera,
                                              const OverlayOptions& options = {});

std::string format_table(const OverlayResult& result);
nlohmann::ordered_json to_json(const OverlayResult& result);

}  // namespace planecast::engine
