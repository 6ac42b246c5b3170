#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/fitting/plane_model.h"
#include "slam/stages/plane_points.h"

namespace planecast::slam {

/// Points of a keyframe about which the surface faces about one way.
struct DirectionGroup {
  std::vector<int> points;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< zero: any
};

/// Splits those points of the pool whose normal is known by the way they face, largest group first
/// [D]. The edges of a stair fill a slab along its slope better than any step does, and so do rows
/// of things; what faces another way is not on the plane. Groups smaller than `min_size` are left
/// out.
std::vector<DirectionGroup> groups_by_direction(const KeyframePoints& shown, std::vector<int> pool,
                                                int min_size);

/// A PlaneModel whose planes face within 25 degrees of a direction.
class FacingPlaneModel {
 public:
  using Parameters = PlaneEquation;
  static constexpr int kSampleSize = PlaneModel::kSampleSize;

  /// The points are kept by reference. A direction of zero allows any plane.
  FacingPlaneModel(const PlanePoints& points, const Eigen::Vector3d& direction)
      : model_(points), direction_(direction) {}
  int size() const { return model_.size(); }
  bool fit_minimal(const int* sample, Parameters& model) const {
    return model_.fit_minimal(sample, model) && faces(model);
  }
  bool fit_least_squares(const std::vector<int>& points, Parameters& model) const {
    return model_.fit_least_squares(points, model) && faces(model);
  }
  void squared_residuals(const Parameters& model, int begin, int end, double* out) const {
    model_.squared_residuals(model, begin, end, out);
  }

 private:
  bool faces(const Parameters& model) const;

  PlaneModel model_;
  Eigen::Vector3d direction_;
};

}  // namespace planecast::slam
