#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/optimize/bundle.h"
#include "slam/segmentation/plane_segmenter.h"
#include "slam/stages/describe_keyframe.h"
#include "slam/stages/free_space.h"
#include "slam/stages/initialise.h"
#include "slam/stages/localise.h"
#include "slam/stages/map_planes.h"
#include "slam/stages/map_points.h"
#include "slam/stages/search_points.h"

namespace planecast::slam {

/// Milliseconds by stage, in the order of the stages. For the record only: no result depends on it.
using StageTimes = std::vector<std::pair<std::string, double>>;

struct KeyframeMapperOptions {
  bool rgbd = false;
  bool map_planes = true;
  PrepareOptions prepare;
  FreeSpaceOptions free_space;
  DescribeKeyframeOptions describe;
  bool search_by_patches = true;  ///< new landmarks by search_points, else by descriptors
  SearchPointsOptions search;
  PointMappingOptions points;
  PlaneMappingOptions planes;
  BundleOptions bundle;
};

/// A frame that is to become a keyframe, as the tracker hands it over.
struct KeyframeJob {
  ImageFeatures image;    ///< with features only where the tracker used them
  PoseEstimate estimate;  ///< its landmarks are those of the tracker's map
  KeyframeId reference = kNone;
  Pose cam_from_reference = Pose::Identity();  ///< as Map::relative_to_keyframe() gives it
  std::vector<LandmarkId> visible;  ///< expected in a frame since the last job, once a frame
  std::vector<LandmarkId> found;    ///< ... and found there
};

struct KeyframeReport {
  KeyframeId keyframe = kNone;
  PointMappingStats points;
  PlaneMappingStats planes;
  BundleResult bundle;
  StageTimes times;
};

/// Local mapping: everything that happens when a keyframe is inserted, in the paper's order. Works
/// on a map of its own that nobody else touches meanwhile.
class KeyframeMapper {
 public:
  KeyframeMapper(const KeyframeMapperOptions& options, const Camera& camera,
                 std::unique_ptr<PlaneSegmenter> segmenter);
  /// Name and version of what says where planes are.
  std::string segmentation() const { return segmenter_->name(); }

  /// Planes of a map that was just initialised. `images`: those of its keyframes, in order.
  KeyframeReport start(Map& map, const std::vector<ImageFeatures>& images);
  KeyframeReport insert(Map& map, KeyframeJob job);
  /// Brings the planes along after the map was changed as a whole.
  void follow_map(Map& map) { plane_mapper_.follow_map(map); }
  /// Looks for planes once more in a map to which no keyframe will be added.
  void finish_planes(Map& map) {
    PlaneMappingStats stats;
    plane_mapper_.finish(map, stats);
  }
  /// Looks for planes in the depth of pairs of keyframes, when nothing will move any more.
  void find_planes_in_stereo(Map& map, int threads) { plane_mapper_.find_in_stereo(map, threads); }
  PlaneScale plane_scale() const { return plane_mapper_.scale(); }
  /// Forgets everything about the map before.
  void reset();

 private:
  void map_planes_at_start(Map& map, const std::vector<ImageFeatures>& images,
                           KeyframeReport& report);
  /// Leaves out of the image's depth and features what came where earlier keyframes saw through.
  void leave_out_moving(const Map& map, KeyframeJob& job) const;
  KeyframeId put_keyframe(Map& map, KeyframeJob& job, StageTimes& times);
  void create_points(Map& map, KeyframeId id, const ImageFeatures& image, PointMappingStats& stats,
                     StageTimes& times);
  void segment(const ImageFeatures& image, Keyframe& keyframe, StageTimes& times);

  KeyframeMapperOptions options_;
  Camera camera_;
  std::unique_ptr<PlaneSegmenter> segmenter_;
  ImagePreparer preparer_;
  PlaneMapper plane_mapper_;
  SearchLog search_log_;
};

}  // namespace planecast::slam
