#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <array>

#include "slam/geometry/sim3.h"

namespace planecast::slam {

/// cam_from_world similarity as Ceres sees it: quaternion (x, y, z, w), translation, ln scale.
using SimilarityBlock = std::array<double, 8>;

SimilarityBlock block_from_similarity(const Similarity& similarity);
Similarity similarity_from_block(const double* block);

/// Similarities under the left perturbation (omega, v, ln scale): q' = exp(omega) q,
/// t' = e^lnscale exp(omega) t + v, scale' = e^lnscale scale. Costs give their derivatives by it in
/// the first seven columns and 0 in the eighth, so the Jacobian of Plus is the identity above a row
/// of zeros. A rigid one keeps the scale and has six dimensions.
class SimilarityManifold final : public ceres::Manifold {
 public:
  explicit SimilarityManifold(bool with_scale) : tangent_(with_scale ? 7 : 6) {}
  int AmbientSize() const override { return 8; }
  int TangentSize() const override { return tangent_; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  int tangent_;
};

/// Edge of a pose graph. With the error E = to_from_from * S_from * S_to^-1 the residuals are
/// weight * (Log of E's rotation, E's translation over `length`, ln of E's scale). Blocks: S_from,
/// S_to (cam_from_world each).
class SimilarityEdgeCost final : public ceres::SizedCostFunction<7, 8, 8> {
 public:
  SimilarityEdgeCost(const Similarity& to_from_from, double weight, double length)
      : to_from_from_(to_from_from), weight_(weight), length_(length) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Similarity to_from_from_;
  double weight_;
  double length_;
};

}  // namespace planecast::slam
