#pragma once

#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"
#include "slam/geometry/two_view.h"

namespace planecast::slam {

/// Gauss-Newton on the Sampson distance (Hartley, Zisserman, section 11.4.3) of the pairs in
/// `used`, over rotation and direction of translation (5 parameters). Precondition: |t| = 1; so has
/// the result. Without enough pairs, or where the error would rise, the pose comes back as it was.
Pose refine_relative_pose(const Pose& cur_from_ref, const std::vector<PointPair>& pairs,
                          const std::vector<char>& used, const Camera& camera);

/// Sampson distance of a pair of rays (x, y, 1) in the units of the rays, and its derivatives by
/// the left perturbation exp(w) R of the rotation and by the coordinates of t in `tangent`, a basis
/// of the plane that is orthogonal to t. Exposed for the test of the derivatives.
struct SampsonTerm {
  double residual = 0.0;
  Eigen::Matrix<double, 1, 5> jacobian;
};
class SampsonModel {
 public:
  explicit SampsonModel(const Pose& cur_from_ref);
  SampsonTerm evaluate(const Eigen::Vector3d& ray_ref, const Eigen::Vector3d& ray_cur) const;
  /// The pose that a step leads to.
  Pose stepped(const Eigen::Matrix<double, 5, 1>& step) const;

 private:
  Pose pose_;
  Eigen::Matrix<double, 3, 2> tangent_;
  Eigen::Matrix3d essential_;
  Eigen::Matrix3d derivative_[5];
};

}  // namespace planecast::slam
