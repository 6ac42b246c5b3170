#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <array>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// cam_from_world as Ceres sees it: quaternion (x, y, z, w), translation.
using PoseBlock = std::array<double, 7>;

PoseBlock block_from_pose(const Pose& cam_from_world);
Pose pose_from_block(const PoseBlock& block);

/// Poses under the left perturbation of geometry/pose_system.h (omega, v). Cost functions on a
/// PoseBlock give their derivatives by this perturbation in the first six columns and 0 in the
/// seventh; the Jacobian of Plus is the identity above a row of zeros accordingly, which spares the
/// detour over the quaternion's derivatives.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// One sight of a landmark, with what its residual needs.
struct ReprojectionTerm {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< undistorted
  double inverse_sigma = 1.0;                       ///< 1 / px
  double inverse_depth = 0.0;                       ///< 1 / measured depth; 0 = none
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  double baseline_fx = 0.0;  ///< of the virtual stereo pair; see PoseOptions

  ReprojectionTerm(const Camera& camera, double depth_baseline_m, const Eigen::Vector2d& pixel,
                   double sigma_px, double depth);

  int rows() const { return inverse_depth > 0.0 ? 3 : 2; }
  /// Residuals over sigma: predicted minus measured pixel and, with depth, disparity. `focal`
  /// multiplies fx and fy. Jacobians (row major, `rows` x 7, 3, 1) are written where the pointer is
  /// not null. False, and nothing written, for a point that is not in front of the camera: a solver
  /// then takes a shorter step. Any residual for it would be low enough for Cauchy's loss to let
  /// points go there.
  bool evaluate(const double* pose, const double* point, double focal, double* residuals,
                double* by_pose, double* by_point, double* by_focal) const;
  /// Sum of squared residuals of a point in the camera frame; infinite for one that is not in
  /// front.
  double chi2(const Eigen::Vector3d& point_cam, double focal) const;
  /// Squared distance of the pixel alone, in pixels. Domain: z > 0.
  double squared_error_px(const Eigen::Vector3d& point_cam, double focal) const {
    const double u = focal * fx * point_cam.x() / point_cam.z() + cx - pixel.x();
    const double v = focal * fy * point_cam.y() / point_cam.z() + cy - pixel.y();
    return u * u + v * v;
  }
};

/// Blocks: pose (7), point (3).
template <int kRows>
class ReprojectionCost final : public ceres::SizedCostFunction<kRows, 7, 3> {
 public:
  explicit ReprojectionCost(const ReprojectionTerm& term) : term_(term) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    return term_.evaluate(parameters[0], parameters[1], 1.0, residuals,
                          jacobians == nullptr ? nullptr : jacobians[0],
                          jacobians == nullptr ? nullptr : jacobians[1], nullptr);
  }

 private:
  ReprojectionTerm term_;
};

/// Blocks: pose (7), point (3), focal factor (1).
template <int kRows>
class FocalReprojectionCost final : public ceres::SizedCostFunction<kRows, 7, 3, 1> {
 public:
  explicit FocalReprojectionCost(const ReprojectionTerm& term) : term_(term) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    return term_.evaluate(parameters[0], parameters[1], parameters[2][0], residuals,
                          jacobians == nullptr ? nullptr : jacobians[0],
                          jacobians == nullptr ? nullptr : jacobians[1],
                          jacobians == nullptr ? nullptr : jacobians[2]);
  }

 private:
  ReprojectionTerm term_;
};

/// (focal factor - 1) / sigma. Block: focal factor (1).
class FocalPriorCost final : public ceres::SizedCostFunction<1, 1> {
 public:
  explicit FocalPriorCost(double sigma) : inverse_sigma_(1.0 / sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    residuals[0] = inverse_sigma_ * (parameters[0][0] - 1.0);
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = inverse_sigma_;
    return true;
  }

 private:
  double inverse_sigma_;
};

/// (normal . point + offset) / sigma. Blocks: point (3), unit normal (3), offset (1).
class PointPlaneCost final : public ceres::SizedCostFunction<1, 3, 3, 1> {
 public:
  explicit PointPlaneCost(double sigma) : inverse_sigma_(1.0 / sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double inverse_sigma_;
};

/// (distance of the camera's centre from `anchor` - distance) / sigma. Block: pose (7). Holds the
/// scale where nothing else does.
class CentreDistanceCost final : public ceres::SizedCostFunction<1, 7> {
 public:
  CentreDistanceCost(const Eigen::Vector3d& anchor, double distance, double sigma)
      : anchor_(anchor), distance_(distance), inverse_sigma_(1.0 / sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d anchor_;
  double distance_;
  double inverse_sigma_;
};

}  // namespace planecast::slam
