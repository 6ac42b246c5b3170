#include "slam/fitting/plane_model.h"

#include <Eigen/Geometry>
#include <cmath>

namespace planecast::slam {

namespace {

/// Sine of the angle between two sides below which three points count as being on a line.
constexpr double kMinSine = 0.05;

}  // namespace

PlaneModel::PlaneModel(const PlanePoints& points) : points_(points) {
  weights_.reserve(points.band.size());
  for (const double band : points.band) weights_.push_back(1.0 / (band * band));
}

bool PlaneModel::fit_minimal(const int* sample, Parameters& model) const {
  const Eigen::Vector3d& a = points_.positions[sample[0]];
  const Eigen::Vector3d ab = points_.positions[sample[1]] - a;
  const Eigen::Vector3d ac = points_.positions[sample[2]] - a;
  const Eigen::Vector3d cross = ab.cross(ac);
  const double length = cross.norm();
  if (!(length > kMinSine * ab.norm() * ac.norm())) return false;
  model.normal = cross / length;
  if (!points_.view_from.empty()) {
    int in_front = 0;
    for (int i = 0; i < kSampleSize; ++i) {
      in_front += points_.view_from[sample[i]].dot(model.normal) > 0.0;
    }
    if (in_front == 0) model.normal = -model.normal;
    if (in_front != 0 && in_front != kSampleSize) return false;
  }
  model.offset = -model.normal.dot(a);
  return true;
}

bool PlaneModel::fit_least_squares(const std::vector<int>& points, Parameters& model) const {
  const auto fit = fit_plane(points_.positions, points, weights_);
  if (!fit) return false;
  model = fit->plane;
  if (points_.view_from.empty()) return true;
  Eigen::Vector3d view = Eigen::Vector3d::Zero();
  for (const int i : points) view += points_.view_from[i];
  if (view.dot(model.normal) < 0.0) model = model.flipped();
  return true;
}

void PlaneModel::squared_residuals(const Parameters& model, int begin, int end, double* out) const {
  for (int i = begin; i < end; ++i) {
    const double distance = model.signed_distance(points_.positions[i]);
    double squared = distance * distance;
    if (!weights_.empty()) squared *= weights_[i];
    const bool behind = !points_.view_from.empty() && points_.view_from[i].dot(model.normal) <= 0.0;
    *out++ = behind ? HUGE_VAL : squared;
  }
}

}  // namespace planecast::slam
