#pragma once

#include <vector>

#include "slam/data/camera.h"
#include "slam/geometry/sim3_ransac.h"

namespace planecast::slam {

struct SimilarityRefineOptions {
  bool with_scale = true;
  int iterations = 20;
  double chi2 = 9.21;         ///< beyond it a reprojection is an outlier
  double depth_sigma = 0.05;  ///< of the ratio of a point's two depths
};

using SimilarityResidual = Eigen::Matrix<double, 5, 1>;
using SimilarityJacobian = Eigen::Matrix<double, 5, 7>;

/// Residuals of a pair over sigma: a's reprojection of b's point (2), b's of a's (2), and ln of the
/// ratio of the point's depths in a, and their derivatives by a left perturbation (omega, v, ln
/// scale) of a_from_b. Reprojections alone tell nothing of the scale where the cameras stand in one
/// place, as they do when a loop closes; depths do [D]. False where a point is not in front of a
/// camera.
bool similarity_residual(const Camera& camera, const SimilarityPair& pair,
                         const Similarity& a_from_b, double depth_sigma,
                         SimilarityResidual& residual, SimilarityJacobian& jacobian);

/// exp of a left perturbation (omega, v, ln scale), to first order in v, times `similarity`.
Similarity perturb_left(const Similarity& similarity, const Eigen::Matrix<double, 7, 1>& delta);

/// Levenberg-Marquardt with Huber on the pairs that agree with the start; after it, the agreeing
/// pairs are chosen anew and the rest refined without the robust loss. Inliers are those at the
/// end.
SimilarityResult refine_similarity(const Camera& camera, const std::vector<SimilarityPair>& pairs,
                                   const Similarity& start, const SimilarityRefineOptions& options);

}  // namespace planecast::slam
