#pragma once

#include "slam/optimize/bundle_problem.h"

namespace planecast::slam {

struct SchurOptions {
  int iterations = 10;
  RobustLoss loss = RobustLoss::kHuber;
  double function_tolerance = 1e-4;  ///< relative change of the cost that ends it
  ResidualSpread spread = {};        ///< for Cauchy
  /// Cauchy also ends with a step that moves the poses by less than this: the mean square over
  /// their degrees of freedom, in standard deviations. What would go on changing are points that
  /// few sights pull to and fro.
  double pose_tolerance = 0.0;
};

/// Moves free poses and points to the least cost of the active observations, as solve_bundle does,
/// by Levenberg-Marquardt with the points eliminated landmark by landmark and a dense system in the
/// poses. Made for the window of the local bundle, which is solved at every keyframe: no residual
/// blocks are allocated and nothing is sorted, which takes most of a general solver's time at this
/// size. Everything is summed in the order of the observations. Returns the iterations.
int solve_window(BundleProblem& problem, const SchurOptions& options);

}  // namespace planecast::slam
