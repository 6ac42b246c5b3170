#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

namespace planecast::slam {

/// (normal . point + offset) / sigma for a point measured by depth, fixed in the frame of its
/// keyframe's camera: what a keyframe saw of a plane holds both to each other. Blocks: pose (7, see
/// PoseManifold), unit normal (3), offset (1).
class DepthPlaneCost final : public ceres::SizedCostFunction<1, 7, 3, 1> {
 public:
  DepthPlaneCost(const Eigen::Vector3d& point_cam, double sigma)
      : point_cam_(point_cam), inverse_sigma_(1.0 / sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d point_cam_;
  double inverse_sigma_;
};

}  // namespace planecast::slam
