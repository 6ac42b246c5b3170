#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/evaluate/statistics.h"
#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/data/types.h"

namespace planecast::engine {

/// One frame of a run.
struct FrameRecord {
  int index = 0;
  double timestamp = 0.0;
  std::string state;   ///< "tracked", "localised", "not-initialised", "lost", "unreadable"
  std::string reason;  ///< why it is not tracked; empty otherwise
  int inliers = 0;
  std::optional<slam::Pose> world_from_cam;         ///< final
  std::optional<slam::Pose> causal_world_from_cam;  ///< as it was known at that frame
};

struct KeyframeRecord {
  int frame_index = 0;
  double timestamp = 0.0;
  slam::Pose world_from_cam = slam::Pose::Identity();
};

/// A plane as in planes.json (design.md section 4).
struct PlaneRecord {
  int id = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, towards the cameras that saw it
  double offset = 0.0;                                ///< normal . x + offset = 0
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();   ///< of the plane's own frame
  Eigen::Vector3d x_axis = Eigen::Vector3d::UnitX();
  std::string plane_class = "other";
  int inliers = 0;
  double rms = 0.0;
  double area = 0.0;
  std::vector<Eigen::Vector3d> polygon;  ///< outer ring, counter-clockwise from the normal's side
  std::vector<std::vector<Eigen::Vector3d>> holes;
  int label = 0;
  int first_frame = 0;
  std::vector<int> merged_from;

  slam::Pose world_from_plane() const;
};

/// A plane's own frame as it stood at some time of the first pass.
struct KnownPlane {
  int id = 0;
  slam::Pose world_from_plane = slam::Pose::Identity();
};

/// A keyframe's pose as it stood at some time of the first pass.
struct KnownKeyframe {
  int frame_index = 0;
  slam::Pose world_from_cam = slam::Pose::Identity();
};

/// A change of the map as it became visible during the first pass: what a live device knew.
struct MapChange {
  int frame_index = 0;  ///< holds from this frame on
  /// How the map moved about the camera: the last pose before the change, in the new map, is this
  /// times what it was in the old one.
  slam::Pose new_from_old_world = slam::Pose::Identity();
  std::vector<KnownPlane> planes;        ///< all that are known now, ascending by id
  std::vector<KnownKeyframe> keyframes;  ///< those that are new or moved, ascending by frame
};

struct MapPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3f color_rgb = Eigen::Vector3f::Zero();  ///< 0..255
  int plane = slam::kNone;
};

/// Milliseconds of one frame by stage name, in the order of the stages.
using StageTimes = std::vector<std::pair<std::string, double>>;

/// Distances of the points to their planes, root mean square in map units, before and after the
/// final joint refinement (equal where it was dropped).
struct PlaneRms {
  double before = 0.0;
  double after = 0.0;
};

/// Milliseconds of one stage over the run.
struct TimingRow {
  std::string name;
  Statistics ms;  ///< count 0: the stage never ran
};

/// What SLAM leaves behind: in memory, and as the reconstruction folder on disk.
struct Reconstruction {
  slam::Camera camera;
  bool metric = false;  ///< units are metres, else map units
  std::string mode;     ///< "mono" or "rgbd"
  std::string segmentation;
  std::optional<PlaneRms> plane_rms;
  double median_depth = 1.0;  ///< of the finished map
  std::vector<FrameRecord> frames;
  std::vector<KeyframeRecord> keyframes;
  std::vector<MapChange> map_changes;  ///< ascending by frame
  std::vector<PlaneRecord> planes;
  std::vector<MapPoint> points;
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit, world
  double up_confidence = 0.0;
  std::vector<StageTimes> frame_times;                       ///< per frame
  std::map<std::string, std::vector<double>> mapping_times;  ///< per keyframe and stage
  std::vector<TimingRow> timings;  ///< of one that was read back, whose samples are gone
  std::vector<std::string> warnings;
  std::string stopped;  ///< why it ends before the sequence; empty: it does not. Not read back
  std::shared_ptr<const slam::Map> map;  ///< what map.bin needs to go on from; may be null
};

}  // namespace planecast::engine
