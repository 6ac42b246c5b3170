#pragma once

#include <memory>
#include <optional>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/features/vocabulary.h"
#include "slam/optimize/bundle.h"
#include "slam/optimize/pose_graph.h"
#include "slam/stages/map_points.h"
#include "slam/stages/recognise_places.h"
#include "slam/stages/verify_loop.h"

namespace planecast::slam {

struct LoopOptions {
  PlaceOptions places;
  VerifyOptions verify;
  PointMappingOptions points;  ///< for fusing
  BundleOptions bundle;        ///< global
  bool rgbd = false;
  int essential_weight = 100;  ///< shared landmarks that make an edge of the pose graph [K]
  double min_kept_share =
      0.5;  ///< of the matches that must survive the global bundle adjustment [D]
  int min_keyframes_between = 10;  ///< from one closed loop to the next look-out
};

/// Looks for loops, keyframe after keyframe. One call at a time.
class LoopFinder {
 public:
  LoopFinder(const LoopOptions& options, const Camera& camera,
             std::shared_ptr<const Vocabulary> vocabulary);

  /// Describes the keyframe and looks whether it closes a loop. After one is found no other is
  /// looked for until closed() is called.
  std::optional<LoopMatch> look(Map& map, KeyframeId keyframe);
  void closed(const Map& map);
  void reset();

 private:
  LoopOptions options_;
  Camera camera_;
  std::shared_ptr<const Vocabulary> vocabulary_;
  PlaceDetector detector_;
  bool pending_ = false;
  KeyframeId resume_at_ = 0;
};

/// A map with its loop closed.
struct LoopCorrection {
  LoopMatch match;
  Map map;  ///< planes follow their keyframes, but are not refitted
  PoseGraphResult graph;
  BundleResult bundle;
  int kept_matches = 0;
};

/// Closes the loop in a copy of the map: duplicates fused, pose graph over the essential graph
/// (Sim3 in mono, SE3 in RGB-D), landmarks and planes along with their keyframes, global bundle
/// adjustment. Nothing where the bundle adjustment throws most matches out again: then it was no
/// loop.
std::optional<LoopCorrection> correct_loop(Map map, const Camera& camera, const LoopMatch& match,
                                           const LoopOptions& options);

/// Brings a later state of the same map along: what the correction knows goes where it says, what
/// was added since goes along with its parent or first keyframe, and the loop's duplicates are
/// fused. The caller refits the planes.
void carry_over(const LoopCorrection& correction, const Camera& camera, const LoopOptions& options,
                Map& map);

}  // namespace planecast::slam
