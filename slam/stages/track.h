#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/stages/align_frame.h"
#include "slam/stages/initialise.h"
#include "slam/stages/localise.h"
#include "slam/stages/relocalise.h"

namespace planecast::slam {

/// How a frame is matched with the map.
enum class FrontEnd {
  kPatches,  ///< looks of landmarks, aligned to a fraction of a pixel; features where that fails
  kOrb,      ///< ORB features on every frame, as in the paper
};

/// Defaults [K]; windows are for 640 px image width and scale with it.
struct TrackOptions {
  FrontEnd front_end = FrontEnd::kPatches;
  double motion_window_px = 15.0;
  int min_motion_matches = 20;
  int min_motion_inliers = 10;
  int min_inliers = 30;              ///< to count as tracked
  double keyframe_share_mono = 0.9;  ///< of the reference keyframe's landmarks
  double keyframe_share_rgbd = 0.75;
  int max_keyframe_interval = 30;
  int min_keyframe_interval = 3;
  int weak_inliers = 60;  ///< below it a keyframe may come at once
  /// With patches a keyframe is wanted when fewer than this share of the most landmarks since the
  /// last one is found, or the nearest keyframe is this share of the median depth away.
  double keyframe_share_patches = 0.8;
  double keyframe_distance = 0.1;
  int local_map_age = 5;  ///< frames after which the local map is gathered anew
  AlignFrameOptions align;
  LocaliseByPatchesOptions patches;
  LocaliseOptions localise;
  RelocaliseOptions relocalise;
};

struct TrackResult {
  bool tracked = false;
  bool relocalised = false;
  bool needs_features = false;  ///< patches failed: track again with features
  std::string reason;           ///< why not tracked
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
  /// With features: by descriptors. Without: by patches; the result may ask for features.
  TrackResult track(const ImageFeatures& image, const Map& map);
  /// Tells that the last image is to become a keyframe.
  void keyframe_requested(int frame_index);
  /// A new state of the map: the last pose goes along with its reference, landmarks with their
  /// heirs.
  void follow_map(const Map& map);

 private:
  PoseEstimate predict_and_match(const ImageFeatures& image, const Map& map) const;
  PoseEstimate match_from_last(const ImageFeatures& image, const Map& map, const Pose& predicted,
                               double window_px) const;
  PoseEstimate search_about(const ImageFeatures& image, const Map& map,
                            const Pose& predicted) const;
  TrackResult track_patches(const ImageFeatures& image, const Map& map);
  TrackResult track_features(const ImageFeatures& image, const Map& map);
  std::optional<Pose> align_with_last(const ImageFeatures& image, const Map& map) const;
  void gather_local_map(int frame_index, const Map& map);
  void accept(const ImageFeatures& image, const Map& map, TrackResult& result);
  bool wants_keyframe(const ImageFeatures& image, const Map& map, const TrackResult& result) const;
  bool wants_keyframe_for_patches(const ImageFeatures& image, const Map& map,
                                  const TrackResult& result);

  TrackOptions options_;
  Camera camera_;
  bool rgbd_;
  bool lost_ = true;
  ImageFeatures last_image_;
  PoseEstimate last_;
  std::vector<LandmarkId> last_landmarks_;  ///< that support it
  Pose velocity_ = Pose::Identity();        ///< cam_from_previous_cam
  KeyframeId reference_ = kNone;
  Pose cam_from_reference_ = Pose::Identity();
  int last_keyframe_frame_ = 0;
  int most_found_ = 0;  ///< landmarks in a frame since the last keyframe
  std::vector<KeyframeId> local_keyframes_;
  std::vector<LandmarkId> local_landmarks_;
  int local_map_frame_ = -1;  ///< when it was gathered; -1: to be gathered
};

}  // namespace planecast::slam
