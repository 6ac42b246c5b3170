#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/calibrate/board.h"
#include "engine/pipeline/track_sequence.h"
#include "engine/sequence/sequence.h"
#include "slam/data/camera.h"

namespace planecast::engine {

struct CalibrateOptions {
  slam::LensModel lens = slam::LensModel::kPinhole;
  int most_frames = 300;  ///< evenly spread over the recording, in which the board is looked for
  int most_views = 40;    ///< used, as different from each other as they can be
};

struct CalibrationView {
  int frame = 0;
  BoardView corners;
  double rms_px = 0.0;     ///< reprojection error
  double slant_deg = 0.0;  ///< angle between the board's normal and the optical axis
};

struct Calibration {
  slam::Camera camera;
  int frames = 0;                      ///< looked at
  int found = 0;                       ///< of them, with the board
  std::vector<CalibrationView> views;  ///< used
  int rejected = 0;                    ///< chosen but dropped: their corners do not fit the others
  double rms_px = 0.0;                 ///< reprojection error of all corners used
  double coverage = 0.0;               ///< see corner_coverage()
  std::optional<double> focal_uncertainty;  ///< standard deviation of fx as a share (pinhole)
  std::vector<std::string> warnings;        ///< what to record better
};

/// Camera of a recording of a board (Zhang 2000, by OpenCV; fisheye: Kannala & Brandt 2006). Views
/// whose error is far above the others' are dropped. Frames that cannot be decoded are an error.
/// Throws UserError naming the recording when the board is found in fewer than 3 frames or no
/// camera explains them.
Calibration calibrate_camera(Sequence& recording, const BoardSpec& board,
                             const CalibrateOptions& options, const Progress& progress);

/// The same from corners that were found already; `views[i].frame` may be anything.
Calibration calibrate_from_views(std::vector<CalibrationView> views, cv::Size image_size,
                                 const CalibrateOptions& options);

std::string format_table(const Calibration& calibration);
nlohmann::ordered_json to_json(const Calibration& calibration);

}  // namespace planecast::engine
