#pragma once

#include <cstdint>

#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::slam {

enum class PlaneMerge { kDefault, kPaper };

struct PlaneMappingOptions {
  double eps_d = 0.02;         ///< point-to-plane inlier distance at scale 1 [P]
  double eps_pi = 0.01;        ///< accepted RMS at scale 1 [P]
  double lambda = 0.6;         ///< spatial coherence [P]
  int min_inliers = 12;        ///< below it a fit is no plane
  int strong_inliers = 30;     ///< below it a plane is weak
  int weak_max_keyframes = 5;  ///< a weak plane that has not grown for this long is dropped
  PlaneMerge merge = PlaneMerge::kDefault;
  bool graph_cut = true;  ///< false: plain sequential RANSAC, for the ablation
  bool project = true;    ///< false: landmarks are not projected onto their planes
  std::uint64_t seed = 1;
};

/// Thresholds in map units as used at one keyframe (adaptive scale, algorithms.md section 1 item
/// 11).
struct PlaneScale {
  double eps_d = 0.0;
  double eps_pi = 0.0;
  double link = 0.0;  ///< unit of what lies together: eps_d as it is while a map grows
};

struct PlaneMappingStats {
  int culled = 0;  ///< landmarks removed as non-planar
  int new_planes = 0;
  int merged = 0;
  int expanded = 0;  ///< landmarks that joined
  int reestimated = 0;
  int dropped = 0;
  int refined = 0;  ///< landmarks projected onto their plane
  int refused = 0;  ///< projections refused by the reprojection test
  double cull_ms = 0.0, new_ms = 0.0, merge_expand_ms = 0.0, reestimate_ms = 0.0, refine_ms = 0.0;
};

struct PlaneContext;

/// The plane steps of local mapping (the paper's section "Local Mapping with Plane Expanded and
/// Re-estimated"). Each is its own function; state between calls is in the map alone, but for the
/// scale.
class PlaneMapper {
 public:
  PlaneMapper(const PlaneMappingOptions& options, const Camera& camera, bool rgbd);

  /// Before triangulation: sets the scale from `keyframe`, culls non-planar landmarks.
  void cull_non_planar(Map& map, KeyframeId keyframe, PlaneMappingStats& stats);
  /// After triangulation and fusing, before local BA: new planes, weak ones, expand, merge,
  /// re-estimate, refine.
  void update(Map& map, KeyframeId keyframe, PlaneMappingStats& stats);
  /// After the map moved as a whole or BA changed it: refits every plane to its landmarks.
  void follow_map(Map& map);
  /// [D] Refits the planes of a map that is finished and looks once more, since its depths are
  /// better than they were while it grew: parts of one plane are merged across what is bare between
  /// them, and without masks and depth every keyframe is searched again, by half the thresholds.
  void finish(Map& map, PlaneMappingStats& stats);
  /// [D] Monocular maps, after everything else: see stereo_planes.h.
  void find_in_stereo(Map& map, int threads);
  PlaneScale scale() const { return scale_; }

 private:
  PlaneContext context_of(const Map& map) const;
  void search_again(Map& map, PlaneMappingStats& stats);

  PlaneMappingOptions options_;
  Camera camera_;
  bool rgbd_;
  bool finished_ = false;
  PlaneScale scale_;
};

}  // namespace planecast::slam
