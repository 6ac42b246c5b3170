#pragma once

#include <ceres/ordered_groups.h>
#include <ceres/problem.h>

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/map.h"
#include "slam/optimize/bundle.h"
#include "slam/optimize/reprojection_cost.h"
#include "slam/optimize/robust_loss.h"

namespace planecast::slam {

struct BundleObservation {
  int pose = 0;   ///< index into BundleProblem::poses
  int point = 0;  ///< index into BundleProblem::points
  ReprojectionTerm term;
  bool active = true;  ///< takes part in the next solve
};

/// The part of a map that a bundle adjustment works on, as arrays.
struct BundleProblem {
  std::vector<KeyframeId> keyframes;  ///< ascending
  std::vector<PoseBlock> poses;       ///< per keyframe
  std::vector<char> fixed;            ///< per keyframe
  std::vector<LandmarkId> landmarks;  ///< ascending
  std::vector<Eigen::Vector3d> points;
  std::vector<BundleObservation> observations;  ///< by landmark, then keyframe
  double focal_factor = 1.0;
  double chi2_mono = 0.0;
  double chi2_depth = 0.0;

  bool has_depth() const;
  double threshold(bool depth) const { return depth ? chi2_depth : chi2_mono; }
  double threshold(const BundleObservation& seen) const { return threshold(seen.term.rows() == 3); }
  double chi2(const BundleObservation& seen) const;
};

/// `keyframes` ascend; `fixed` is per keyframe. Landmarks that the keyframes do not determine (a
/// single sight without depth) are left out.
BundleProblem collect_bundle(const Map& map, const Camera& camera,
                             const std::vector<KeyframeId>& keyframes,
                             const std::vector<char>& fixed,
                             const std::vector<LandmarkId>& landmarks,
                             const BundleOptions& options);

/// All keyframes, of which the first is fixed, and all landmarks. Precondition: there is a
/// keyframe.
BundleProblem collect_whole_map(const Map& map, const Camera& camera, const BundleOptions& options);

/// Elimination order. Ceres orders the blocks within a group by address, which is repeatable only
/// for blocks in one array: every array has its own group.
enum BundleGroup { kPointGroup, kPoseGroup, kFocalGroup, kPlaneGroup };

/// From the medians of the active observations, at the present poses and points.
ResidualSpread measure_spread(const BundleProblem& problem);

struct BundleSolve {
  int iterations = 10;
  RobustLoss loss = RobustLoss::kHuber;
  ResidualSpread spread;  ///< for Cauchy
  bool refine_focal = false;
  double focal_sigma = 0.03;         ///< of the factor on the focal length about 1
  double function_tolerance = 1e-5;  ///< relative change of the cost that ends it
  /// Adds further residuals and parameter blocks; what they are made of must outlive the call.
  std::function<void(ceres::Problem&, ceres::ParameterBlockOrdering&)> extend;
};

/// Sum of the losses of the active observations.
double loss_of(const BundleProblem& problem, const BundleSolve& solve);

/// Moves free poses and points to the least cost of the active observations. Returns the
/// iterations.
int solve_bundle(BundleProblem& problem, const BundleSolve& solve);

/// Activates exactly the observations in front of the camera whose chi2 is within `gate` times its
/// threshold; a landmark that is left undetermined loses the rest as well. Returns the number of
/// inactive ones.
int deactivate_outliers(BundleProblem& problem, double gate = 1.0);

/// Root mean square distance in pixels over the active observations.
double reprojection_rms_px(const BundleProblem& problem);

/// Scales free poses and points about the centre of keyframe `anchor` so that keyframe `other` is
/// at `distance` from it again. Returns the factor, 1 where the distance is too small to tell.
double restore_distance(BundleProblem& problem, int anchor, int other, double distance);
double keyframe_distance(const BundleProblem& problem, int anchor, int other);

/// Writes poses and positions back.
void write_back(const BundleProblem& problem, Map& map);
/// Takes the inactive observations out of the map; returns how many.
int remove_inactive(const BundleProblem& problem, Map& map);

}  // namespace planecast::slam
