#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/data/map.h"
#include "slam/features/orb.h"
#include "slam/optimize/bundle.h"
#include "slam/segmentation/plane_segmenter.h"
#include "slam/stages/initialise.h"
#include "slam/stages/map_planes.h"
#include "slam/stages/map_points.h"
#include "slam/stages/track.h"

namespace planecast::slam {

struct SystemOptions {
  bool rgbd = false;
  std::uint64_t seed = 1;
  OrbOptions orb;
  int initial_features = 2000;       ///< per frame until initialised [K]
  double max_keypoint_depth_m = 8.0; ///< depth beyond it is not used
  int restart_after_lost = 20;       ///< frames lost with fewer than restart_keyframes: start again
  int restart_keyframes = 5;
  bool map_planes = true;
  bool refine_jointly = true;        ///< final refinement with the point-plane term
  InitialiseOptions initialise;
  TrackOptions track;
  PointMappingOptions points;
  PlaneMappingOptions planes;
  BundleOptions bundle;
};

enum class TrackState { kNotInitialised, kTracked, kLost };

/// Milliseconds by stage, in the order of the stages. For the record only: no result depends on it.
using StageTimes = std::vector<std::pair<std::string, double>>;

/// What is known of one frame once it was tracked.
struct FrameTrack {
  TrackState state = TrackState::kNotInitialised;
  std::string reason;                  ///< why it is not tracked
  int inliers = 0;
  std::optional<Pose> cam_from_world;  ///< as it was known then
  KeyframeId reference = kNone;        ///< the pose relative to it survives changes of the map
  Pose cam_from_reference = Pose::Identity();
  bool keyframe = false;
  bool restarted = false;              ///< the map was thrown away before this frame
  StageTimes times;
  StageTimes mapping_times;            ///< of the keyframe, if it became one; the paper's Table 2 rows
};

struct FinishResult {
  BundleResult global;
  JointResult joint;
};

/// SLAM over a sequence: prepare() and track() for each frame in turn, finish() at the end, then
/// localise() for any frame against the finished map.
class System {
 public:
  System(const SystemOptions& options, const Camera& camera,
         std::unique_ptr<PlaneSegmenter> segmenter);
  ~System();

  /// Features of a frame, raw and undistorted, with depth. May run on another thread than track(), one
  /// call at a time. `initialised` decides how many features.
  ImageFeatures prepare(const FrameInput& frame, bool initialised) const;
  FrameTrack track(const ImageFeatures& image);
  bool initialised() const { return !map_.keyframes.empty(); }

  /// Global bundle adjustment (with the focal length where it was guessed), planes after it, and the
  /// joint refinement.
  FinishResult finish();
  /// Pose of a frame in the finished map; from the prior if that is near enough, else by relocalisation.
  std::optional<PoseEstimate> localise(const ImageFeatures& image,
                                       const std::optional<Pose>& prior_cam_from_world) const;

  const Map& map() const { return map_; }
  const Camera& camera() const { return camera_; }
  const SystemOptions& options() const { return options_; }

 private:
  void start_mono(const ImageFeatures& image, FrameTrack& result);
  void start_rgbd(const ImageFeatures& image, FrameTrack& result);
  void insert_keyframe(const ImageFeatures& image, const PoseEstimate& estimate,
                       FrameTrack& result);
  void map_planes_after(KeyframeId keyframe, PlaneMappingStats& stats);
  cv::Mat segment(const ImageFeatures& image, StageTimes& times) const;
  void count_visible(const TrackResult& result);
  void restart();

  SystemOptions options_;
  Camera camera_;
  std::unique_ptr<PlaneSegmenter> segmenter_;
  std::unique_ptr<OrbExtractor> extractor_;
  MonoInitialiser initialiser_;
  Tracker tracker_;
  PlaneMapper plane_mapper_;
  Map map_;
  int lost_frames_ = 0;
};

}  // namespace planecast::slam
