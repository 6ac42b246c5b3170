#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "engine/look/environment_file.h"
#include "render/scene.h"

namespace planecast::engine {

struct TurntableOptions {
  int views = 8;           ///< evenly around the vertical axis, the first from the front
  int view_size_px = 320;  ///< side of one square view
  int animation = -1;      ///< -1: rest pose
  double time_s = 0.0;
  double elevation_deg = 20.0;  ///< of the camera over the horizon
  double azimuth_deg = 0.0;     ///< of the first view: 0 looks at the model's front (+z)
  int camera = -1;              ///< of the model's own cameras: one view through it instead
  /// Surroundings that light the model instead of a studio, their colours tone mapped.
  std::optional<EnvironmentLight> environment;
  bool simplify = true;  ///< fewer triangles where the screen does not show the difference
};

/// Whether `model` has a camera of that index.
bool has_camera(const render::Model& model, int camera);

/// The model on a light ground, one view beside the other in rows of at most four, CV_8UC3 BGR.
cv::Mat draw_turntable(const std::shared_ptr<const render::Model>& model,
                       const TurntableOptions& options);

}  // namespace planecast::engine
