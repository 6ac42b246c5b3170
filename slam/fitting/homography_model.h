#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/geometry/two_view.h"

namespace planecast::slam {

/// Homographies between two images for GraphCutRansac, over the pairs given (kept by reference).
/// Residual: symmetric transfer error sqrt((d_forward^2 + d_backward^2) / 2) in pixels; infinite
/// for a point on the far side of either horizon.
class HomographyModel {
 public:
  struct Parameters {
    Eigen::Matrix3d cur_H_ref = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d ref_H_cur = Eigen::Matrix3d::Identity();
  };
  static constexpr int kSampleSize = 4;

  explicit HomographyModel(const std::vector<PointPair>& pairs);
  int size() const { return static_cast<int>(pairs_.size()); }
  /// Exact, over the projective basis of the four points. Refuses three points near a line and
  /// samples that no plane seen from one side explains: every triple must turn the same way in both
  /// images (oriented constraint, Chum et al., "Epipolar geometry estimation via RANSAC benefits
  /// from the oriented epipolar constraint", ICPR 2004).
  bool fit_minimal(const int* sample, Parameters& model) const;
  /// Normalised direct linear transformation (Hartley and Zisserman, Algorithm 4.2).
  bool fit_least_squares(const std::vector<int>& points, Parameters& model) const;
  void squared_residuals(const Parameters& model, int begin, int end, double* out) const;

 private:
  const std::vector<PointPair>& pairs_;
  /// The same by columns, for whole vectors at a time.
  std::vector<double> ref_x_, ref_y_, cur_x_, cur_y_;
};

}  // namespace planecast::slam
