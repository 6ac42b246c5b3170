#include "slam/fitting/plane_model.h"

#include <Eigen/Geometry>
#include <cmath>

#include "slam/data/vector_clones.h"

namespace planecast::slam {

namespace {

/// Sine of the angle between two sides below which three points count as being on a line.
constexpr double kMinSine = 0.05;

}  // namespace

PlaneModel::PlaneModel(const PlanePoints& points) : points_(points) {
  weights_.reserve(points.band.size());
  for (const double band : points.band) weights_.push_back(1.0 / (band * band));
  for (std::vector<double>* column : {&x_, &y_, &z_}) column->reserve(points.positions.size());
  for (const Eigen::Vector3d& p : points.positions) {
    x_.push_back(p.x());
    y_.push_back(p.y());
    z_.push_back(p.z());
  }
  for (std::vector<double>* column : {&view_x_, &view_y_, &view_z_}) {
    column->reserve(points.view_from.size());
  }
  for (const Eigen::Vector3d& v : points.view_from) {
    view_x_.push_back(v.x());
    view_y_.push_back(v.y());
    view_z_.push_back(v.z());
  }
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

PLANECAST_VECTOR_CLONES
void PlaneModel::squared_residuals(const Parameters& model, int begin, int end, double* out) const {
  const double a = model.normal.x();
  const double b = model.normal.y();
  const double c = model.normal.z();
  const double d = model.offset;
  const int n = end - begin;
  const double* const x = x_.data() + begin;
  const double* const y = y_.data() + begin;
  const double* const z = z_.data() + begin;
  for (int i = 0; i < n; ++i) {
    const double distance = a * x[i] + b * y[i] + c * z[i] + d;
    out[i] = distance * distance;
  }
  if (!weights_.empty()) {
    const double* const weight = weights_.data() + begin;
    for (int i = 0; i < n; ++i) out[i] *= weight[i];
  }
  if (points_.view_from.empty()) return;
  const double* const view_x = view_x_.data() + begin;
  const double* const view_y = view_y_.data() + begin;
  const double* const view_z = view_z_.data() + begin;
  for (int i = 0; i < n; ++i) {
    const double facing = a * view_x[i] + b * view_y[i] + c * view_z[i];
    out[i] = facing <= 0.0 ? HUGE_VAL : out[i];
  }
}

}  // namespace planecast::slam
