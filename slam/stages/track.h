#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/stages/initialise.h"
#include "slam/stages/localise.h"
#include "slam/stages/relocalise.h"

namespace planecast::slam {

/// Defaults [K]; windows are for 640 px image width and scale with it.
struct TrackOptions {
  double motion_window_px = 15.0;
  int min_motion_matches = 20;
  int min_motion_inliers = 10;
  int min_inliers = 30;             ///< to count as tracked
  double keyframe_share_mono = 0.9; ///< of the reference keyframe's landmarks
  double keyframe_share_rgbd = 0.75;
  int max_keyframe_interval = 30;
  int min_keyframe_interval = 3;
  int weak_inliers = 60;            ///< below it a keyframe may come at once
  LocaliseOptions localise;
  RelocaliseOptions relocalise;
};

struct TrackResult {
  bool tracked = false;
  bool relocalised = false;
  std::string reason;  ///< why not tracked
  PoseEstimate estimate;
  KeyframeId reference = kNone;  ///< shares the most landmarks with the image
  bool want_keyframe = false;
};

/// Frame after frame against a map that it does not change.
class Tracker {
 public:
  Tracker(const TrackOptions& options, const Camera& camera, bool rgbd);

  /// Starts from a known pose (after initialisation).
  void start(const ImageFeatures& image, const PoseEstimate& estimate, KeyframeId reference);
  TrackResult track(const ImageFeatures& image, const Map& map);
  /// Tells that the last image is to become a keyframe.
  void keyframe_requested(int frame_index) { last_keyframe_frame_ = frame_index; }
  /// A new state of the map: the last pose goes along with its reference, landmarks with their heirs.
  void follow_map(const Map& map);

 private:
  PoseEstimate predict_and_match(const ImageFeatures& image, const Map& map) const;
  PoseEstimate match_from_last(const ImageFeatures& image, const Map& map, const Pose& predicted,
                               double window_px) const;
  bool wants_keyframe(const ImageFeatures& image, const Map& map, const TrackResult& result) const;

  TrackOptions options_;
  Camera camera_;
  bool rgbd_;
  bool lost_ = true;
  ImageFeatures last_image_;
  PoseEstimate last_;
  Pose velocity_ = Pose::Identity();  ///< cam_from_previous_cam
  KeyframeId reference_ = kNone;
  Pose cam_from_reference_ = Pose::Identity();
  int last_keyframe_frame_ = 0;
};

}  // namespace planecast::slam
