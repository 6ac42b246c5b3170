#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/geometry/plane_geometry.h"

namespace planecast::slam {

/// Points to which planes are fitted.
struct PlanePoints {
  std::vector<Eigen::Vector3d> positions;
  /// Unit direction from each towards the cameras that saw it; empty: unknown.
  std::vector<Eigen::Vector3d> view_from;
  /// A point's own inlier band divided by the common threshold, >= 1 (noisy depth); empty: all 1.
  std::vector<double> band;

  int size() const { return static_cast<int>(positions.size()); }
};

/// Planes for GraphCutRansac, over the points given (kept by reference). Residual: point-plane
/// distance divided by the point's band; infinite for a point seen from behind the plane. Normals
/// point to the side from which the sample was seen.
class PlaneModel {
 public:
  using Parameters = PlaneEquation;
  static constexpr int kSampleSize = 3;

  explicit PlaneModel(const PlanePoints& points);
  int size() const { return points_.size(); }
  /// Refuses three points near a line and samples not all seen from one side.
  bool fit_minimal(const int* sample, Parameters& model) const;
  /// Weighted by 1 / band^2.
  bool fit_least_squares(const std::vector<int>& points, Parameters& model) const;
  void squared_residuals(const Parameters& model, int begin, int end, double* out) const;

 private:
  const PlanePoints& points_;
  std::vector<double> weights_;  ///< 1 / band^2; empty: all 1
  /// Positions and directions by columns, for whole vectors at a time.
  std::vector<double> x_, y_, z_, view_x_, view_y_, view_z_;
};

}  // namespace planecast::slam
