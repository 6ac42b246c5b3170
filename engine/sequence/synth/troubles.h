#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "engine/sequence/synth/camera_path.h"
#include "slam/data/camera.h"

namespace planecast::engine::synth {

/// What makes a recording hard, on top of any scene.
struct Trouble {
  double shutter_s = 0.0;       ///< motion blur; 0: the scene's own
  double speed = 1.0;           ///< of the camera along its path
  bool exposure_jumps = false;  ///< the gain changes at once, by up to 3.5 times
  double readout_s = 0.0;       ///< rolling shutter: from the first row to the last
  bool passer = false;          ///< something near moves across the view
  double dropped_share = 0.0;   ///< of the frames, beside a gap now and then
};

/// none, blur, exposure, rolling-shutter, moving, dropped.
std::vector<std::string> trouble_names();
/// Throws std::invalid_argument for a name that is none of them.
Trouble trouble_named(const std::string& name);

/// Whether the recorder lost this frame. Never the first.
bool is_dropped(const Trouble& trouble, int frame, double time_s, std::uint64_t seed);

/// An upright card of 0.5 x 1.1 m that crosses the view 1 m before the camera, every four seconds.
class Passer {
 public:
  explicit Passer(std::uint64_t seed);

  /// Draws it into the pictures of `camera` (8-bit BGR, 8-bit labels, CV_32F depth in metres),
  /// where it is nearer than what they show. It has no label.
  void draw(const CameraPath& path, const slam::Camera& camera, double time_s, cv::Mat& bgr,
            cv::Mat& labels, cv::Mat& depth_m) const;

 private:
  cv::Mat picture_;
};

}  // namespace planecast::engine::synth
