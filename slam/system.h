#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/frame.h"
#include "slam/data/map.h"
#include "slam/features/orb.h"
#include "slam/optimize/bundle.h"
#include "slam/segmentation/plane_segmenter.h"
#include "slam/stages/close_loops.h"
#include "slam/stages/initialise.h"
#include "slam/stages/map_keyframe.h"
#include "slam/stages/track.h"

namespace planecast::slam {

struct SystemOptions {
  bool rgbd = false;
  std::uint64_t seed = 1;
  int threads = 2;  ///< 1: mapping runs inline, on the same schedule and with the same results
  int mapping_delay = 4;    ///< frames after which a keyframe's result is visible; 0 = lock-step
  int loop_delay = 30;      ///< frames after a loop's keyframe until the closed loop is visible
  bool close_loops = true;  ///< needs the vocabulary
  std::shared_ptr<const Vocabulary> vocabulary;  ///< for place recognition; may be null
  OrbOptions orb;
  /// Levels of the patch front end's features, in place of orb.levels. Their patches are aligned at
  /// half-scale levels, so that an octave only says how large a corner is: four of 1.5 reach as far
  /// as eight of 1.2 and have half the pixels.
  ScaleLevels patch_levels = {4, 1.5};
  int initial_features = 2000;        ///< per frame until initialised [K]
  double max_keypoint_depth_m = 8.0;  ///< depth beyond it is not used
  int restart_after_lost = 20;  ///< frames lost with fewer than restart_keyframes: start again
  int restart_keyframes = 5;
  int localise_matches = 600;  ///< landmarks a frame, in localise()
  /// Of the landmarks in a frame's field of view, in localise(): the finished map knows many that
  /// walls hide there.
  double localise_min_share = 0.15;
  bool refine_jointly = true;  ///< final refinement with the point-plane term
  InitialiseOptions initialise;
  TrackOptions track;
  KeyframeMapperOptions mapping;
  LoopOptions loops;
};

enum class TrackState { kNotInitialised, kTracked, kLost };

/// What is known of one frame once it was tracked.
struct FrameTrack {
  TrackState state = TrackState::kNotInitialised;
  std::string reason;  ///< why it is not tracked
  int inliers = 0;
  std::optional<Pose> cam_from_world;  ///< as it was known then
  KeyframeId reference = kNone;        ///< the pose relative to it survives changes of the map
  Pose cam_from_reference = Pose::Identity();  ///< as Map::relative_to_keyframe() gives it
  bool keyframe = false;
  bool restarted = false;  ///< the map was thrown away before this frame
  StageTimes times;
  StageTimes mapping_times;  ///< of the keyframe whose result became visible here
  bool loop_closed = false;  ///< a closed loop became visible here
};

struct FinishResult {
  StageTimes mapping_times;  ///< of keyframes that were still in flight, one after the other
  bool loop_closed = false;  ///< one that was still being closed
  BundleResult global;
  JointResult joint;
};

/// SLAM over a sequence: prepare() and track() for each frame in turn, finish() at the end, then
/// localise() for any frame against the finished map.
///
/// Mapping runs beside tracking on a copy of the map. The result of the keyframe inserted at frame
/// n becomes visible at frame n + mapping_delay, never earlier or later, so that no result depends
/// on timing; the tracker waits if the mapper is late. A loop found with that keyframe is closed
/// beside both on a copy of the map and carried over to the map as it is then: visible at frame
/// n + loop_delay.
class System {
 public:
  System(const SystemOptions& options, const Camera& camera,
         std::unique_ptr<PlaneSegmenter> segmenter);
  ~System();

  /// Name and version of what gives the plane masks.
  std::string segmentation() const { return mapper_.segmentation(); }

  /// Starts from an earlier map of the same camera instead of an empty one: the first frames are
  /// relocalised in it and mapping goes on from there. Before the first frame.
  void load(Map map);

  /// What tracking needs of a frame: its pyramid, and features where the front end or the start of
  /// the map wants them (more before it is `initialised`). May run on another thread than track(),
  /// one call at a time.
  ImageFeatures prepare(const FrameInput& frame, bool initialised) const;
  FrameTrack track(ImageFeatures image);
  bool initialised() const { return !map().keyframes.empty(); }

  /// All sights aligned anew, global bundle adjustment (with the focal length where it was
  /// guessed), planes after it, and the joint refinement.
  FinishResult finish();
  /// Pose of a frame in the finished map: by the landmarks' looks from the first prior that is near
  /// enough, else from where keypoints put it.
  std::optional<PoseEstimate> localise(ImageFeatures image,
                                       const std::vector<Pose>& priors_cam_from_world) const;

  /// The map as the tracker sees it.
  const Map& map() const { return *visible_map_; }
  const Camera& camera() const { return camera_; }
  const SystemOptions& options() const { return options_; }

 private:
  /// A state of the map and what led to it.
  struct Mapped {
    std::shared_ptr<const Map> map;
    KeyframeReport report;
    std::optional<LoopMatch> loop;  ///< found with this keyframe
    bool loop_closed = false;
  };
  struct InFlight {
    int inserted_at = 0;  ///< frame index
    int visible_at = 0;   ///< frame index
    std::shared_future<Mapped> result;
  };
  using MapJob = std::function<Mapped()>;
  /// A loop that is being closed on a copy of the map.
  struct OpenLoop {
    int visible_at;  ///< frame index
    std::shared_future<std::optional<LoopCorrection>> correction;
  };

  void start(ImageFeatures& image, FrameTrack& result);
  TrackResult track_in_map(ImageFeatures& image);
  void hand_over(const ImageFeatures& image, const TrackResult& tracked, FrameTrack& result);
  void enqueue(int frame_index, int visible_at, MapJob job);
  void take_over(InFlight flight, FrameTrack& result);
  void take_over_due(int frame_index, FrameTrack& result);
  void take_over_all(FrameTrack& result);
  void begin_loop(const Mapped& mapped, int inserted_at);
  void enqueue_open_loop(int frame_index);
  void restart();
  /// The two ways of localise(): by the landmarks' looks about a nearly known pose, and by
  /// keypoints from a roughly known one or none.
  std::optional<PoseEstimate> localise_from(const ImageFeatures& image,
                                            const Pose& guess_cam_from_world) const;
  std::optional<PoseEstimate> localise_by_keypoints(
      const Features& features, const std::optional<Pose>& prior_cam_from_world) const;

  SystemOptions options_;
  Camera camera_;
  std::unique_ptr<ImagePreparer> preparer_;          ///< prepare()'s
  std::unique_ptr<ImagePreparer> tracker_preparer_;  ///< the tracker's, where it asks for features
  MonoInitialiser initialiser_;
  Tracker tracker_;
  KeyframeMapper mapper_;  ///< used by one job at a time
  Map working_map_;        ///< the mapper's
  std::shared_ptr<const Map> visible_map_ = std::make_shared<const Map>();
  std::deque<InFlight> in_flight_;
  std::optional<LoopFinder> loop_finder_;  ///< used by one job at a time; none: no loops are closed
  std::optional<OpenLoop> open_loop_;
  KeyframeJob next_job_;  ///< gathers the counters for it
  int lost_frames_ = 0;
  bool loaded_ = false;  ///< the map came from elsewhere and is never thrown away
};

}  // namespace planecast::slam
