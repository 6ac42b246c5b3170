#pragma once

#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::slam {

struct BundleOptions {
  int iterations = 10;
  double chi2_mono = 5.991;
  double chi2_depth = 7.815;
  double depth_baseline_m = 0.08;  ///< as in PoseOptions
  int max_local_keyframes = 9;     ///< free keyframes of the local bundle, best covisible first
  int max_fixed_keyframes = 12;    ///< seen by the same landmarks, held
  bool refine_focal = false;       ///< global only: one common factor on fx and fy
  /// Spread of a guessed focal length, as a share of it: a field of view of 60 degrees stands for
  /// 55 to 66.
  double focal_sigma = 0.1;
  /// What the views say of the focal length counts for this share of its weight: their residuals
  /// are not independent, as all share the errors of a principal point and a lens that nobody
  /// knows.
  double focal_independence = 0.1;
  ScaleLevels levels;
};

struct BundleResult {
  int free_keyframes = 0;
  int fixed_keyframes = 0;
  int landmarks = 0;
  int observations = 0;
  int removed_observations = 0;  ///< outliers taken out of the map
  double rms_before_px = 0.0;
  double rms_after_px = 0.0;
  int iterations = 0;
  double focal_factor = 1.0;  ///< refined fx / given fx
};

/// Analytic Jacobians, Schur elimination; the global one by Ceres with num_threads = 1 (two are not
/// repeatable), the local one by solve_window. Two passes with the outliers removed between and
/// after, with Cauchy at the spread that most sights have, but for the first pass of the global one
/// (Huber), as its start may be far off. Poses, landmarks and observations of `map` are updated;
/// planes are not touched. The first keyframe of the map (and, in mono, what fixes the gauge) is
/// held.
BundleResult local_bundle(Map& map, const Camera& camera, KeyframeId centre,
                          const BundleOptions& options);
/// All keyframes and landmarks. Where options.refine_focal is set, `camera` is updated and so are,
/// by the caller, the undistorted pixels.
BundleResult global_bundle(Map& map, Camera& camera, const BundleOptions& options);

struct JointOptions {
  BundleOptions bundle;
  double plane_sigma = 0.01;  ///< eps_Pi in map units
  /// The result is dropped if the robust reprojection cost rises by more than this share.
  double max_reprojection_rise = 0.01;
  /// How often plane_sigma is doubled and the refinement tried anew before it is dropped. Holding a
  /// point of n sights to its plane takes one of its 2 n - 3 degrees of freedom, so that even true
  /// planes raise the cost by a few per cent when they bind tightly.
  int max_relaxations = 5;
};

struct JointResult {
  bool kept = false;
  double plane_sigma = 0.0;               ///< of the last try
  double reprojection_cost_before = 0.0;  ///< robust
  double reprojection_cost_after = 0.0;   ///< of the last try
  double plane_rms_before = 0.0;          ///< of owned landmarks, map units
  double plane_rms_after = 0.0;           ///< of the last try
};

/// Final joint refinement of poses, landmarks and planes (the paper's last equation): reprojection
/// and (n.v + d)/plane_sigma with Cauchy, planes on the unit sphere x R. A monocular map keeps the
/// distance between its first keyframe and the one farthest from it. No observation is removed.
JointResult refine_jointly(Map& map, const Camera& camera, const JointOptions& options);

}  // namespace planecast::slam
