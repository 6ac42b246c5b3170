#include "slam/fitting/homography_model.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "slam/data/vector_clones.h"

namespace planecast::slam {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Twice the area, in square pixels, below which three points count as being on a line.
constexpr double kMinDoubleArea = 20.0;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Four points as a projective basis: homogeneous p3 = sum of weight_i p_i / area, with the doubled
/// signed areas of the triangles.
struct Basis {
  Matrix3d points;    ///< columns (x, y, 1) of the first three
  Matrix3d adjugate;  ///< points^-1 * area
  Vector3d weight;
  double area = 0.0;
};

Basis make_basis(const Vector2d& p0, const Vector2d& p1, const Vector2d& p2, const Vector2d& p3) {
  Basis basis;
  basis.points << p0.x(), p1.x(), p2.x(), p0.y(), p1.y(), p2.y(), 1.0, 1.0, 1.0;
  basis.adjugate << p1.y() - p2.y(), p2.x() - p1.x(), cross(p1, p2),  //
      p2.y() - p0.y(), p0.x() - p2.x(), cross(p2, p0),                //
      p0.y() - p1.y(), p1.x() - p0.x(), cross(p0, p1);
  basis.weight = basis.adjugate * Vector3d(p3.x(), p3.y(), 1.0);
  basis.area = basis.weight.sum();
  return basis;
}

bool is_degenerate(const Basis& basis) {
  return std::abs(basis.area) < kMinDoubleArea ||
         basis.weight.cwiseAbs().minCoeff() < kMinDoubleArea;
}

/// Shift and scale that bring points to mean 0 and mean distance sqrt(2).
struct Normalisation {
  Vector2d mean = Vector2d::Zero();
  double scale = 1.0;

  Vector2d apply(const Vector2d& p) const { return scale * (p - mean); }
  Matrix3d matrix() const {
    Matrix3d m;
    m << scale, 0.0, -scale * mean.x(), 0.0, scale, -scale * mean.y(), 0.0, 0.0, 1.0;
    return m;
  }
  Matrix3d inverse() const {
    Matrix3d m;
    m << 1.0 / scale, 0.0, mean.x(), 0.0, 1.0 / scale, mean.y(), 0.0, 0.0, 1.0;
    return m;
  }
};

template <typename Get>
Normalisation normalise(const std::vector<int>& points, Get get) {
  Normalisation result;
  for (const int i : points) result.mean += get(i);
  result.mean /= static_cast<double>(points.size());
  double distance = 0.0;
  for (const int i : points) distance += (get(i) - result.mean).norm();
  if (distance > 0.0) result.scale = std::sqrt(2.0) * static_cast<double>(points.size()) / distance;
  return result;
}

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

/// A^T A of the equations of all pairs, built from its 3x3 blocks: with p = (x, y, 1) the rows are
/// (0, -p, v p) and (p, 0, -u p).
Matrix9d normal_matrix(const std::vector<PointPair>& pairs, const std::vector<int>& points,
                       const Normalisation& ref, const Normalisation& cur) {
  Matrix3d plain = Matrix3d::Zero();
  Matrix3d by_u = Matrix3d::Zero();
  Matrix3d by_v = Matrix3d::Zero();
  Matrix3d by_square = Matrix3d::Zero();
  for (const int i : points) {
    const Vector3d p = ref.apply(pairs[i].ref).homogeneous();
    const Vector2d q = cur.apply(pairs[i].cur);
    const Matrix3d outer = p * p.transpose();
    plain += outer;
    by_u += q.x() * outer;
    by_v += q.y() * outer;
    by_square += q.squaredNorm() * outer;
  }
  Matrix9d m = Matrix9d::Zero();
  m.block<3, 3>(0, 0) = plain;
  m.block<3, 3>(3, 3) = plain;
  m.block<3, 3>(0, 6) = m.block<3, 3>(6, 0) = -by_u;
  m.block<3, 3>(3, 6) = m.block<3, 3>(6, 3) = -by_v;
  m.block<3, 3>(6, 6) = by_square;
  return m;
}

/// By inverse iteration, a tenth of the time of a whole decomposition. The eigenvalue sought is the
/// noise's and far below the next, so that few steps do; the shift keeps the factorisation of exact
/// data regular.
Vector9d smallest_eigenvector(Matrix9d m) {
  constexpr int kSteps = 4;
  m.diagonal().array() += 1e-14 * m.trace();
  const Eigen::LDLT<Matrix9d> factors(m);
  Vector9d h;
  h << 1.0, 0.1, 0.1, -0.1, 1.0, 0.1, 0.1, -0.1, 1.0;
  for (int step = 0; step < kSteps; ++step) h = factors.solve(h).normalized();
  return h;
}

}  // namespace

HomographyModel::HomographyModel(const std::vector<PointPair>& pairs) : pairs_(pairs) {
  for (std::vector<double>* column : {&ref_x_, &ref_y_, &cur_x_, &cur_y_}) {
    column->reserve(pairs.size());
  }
  for (const PointPair& pair : pairs) {
    ref_x_.push_back(pair.ref.x());
    ref_y_.push_back(pair.ref.y());
    cur_x_.push_back(pair.cur.x());
    cur_y_.push_back(pair.cur.y());
  }
}

bool HomographyModel::fit_minimal(const int* sample, Parameters& model) const {
  const PointPair& a = pairs_[sample[0]];
  const PointPair& b = pairs_[sample[1]];
  const PointPair& c = pairs_[sample[2]];
  const PointPair& d = pairs_[sample[3]];
  const Basis ref = make_basis(a.ref, b.ref, c.ref, d.ref);
  if (is_degenerate(ref)) return false;
  const Basis cur = make_basis(a.cur, b.cur, c.cur, d.cur);
  if (is_degenerate(cur)) return false;
  if (ref.area * cur.area < 0.0 || (ref.weight.array() * cur.weight.array() < 0.0).any()) {
    return false;
  }
  // All ratios are positive here, and with them the third homogeneous coordinate of the sample.
  const Vector3d ratio = cur.weight.cwiseQuotient(ref.weight);
  model.cur_H_ref = cur.points * ratio.asDiagonal() * ref.adjugate / ref.area;
  model.ref_H_cur = ref.points * ratio.cwiseInverse().asDiagonal() * cur.adjugate / cur.area;
  return true;
}

bool HomographyModel::fit_least_squares(const std::vector<int>& points, Parameters& model) const {
  if (points.size() < static_cast<std::size_t>(kSampleSize)) return false;
  const auto ref = normalise(points, [this](int i) -> const Vector2d& { return pairs_[i].ref; });
  const auto cur = normalise(points, [this](int i) -> const Vector2d& { return pairs_[i].cur; });
  const Vector9d h = smallest_eigenvector(normal_matrix(pairs_, points, ref, cur));
  Matrix3d normalised;
  normalised << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8);
  if (!(std::abs(normalised.determinant()) > 1e-9)) return false;
  model.cur_H_ref = cur.inverse() * normalised * ref.matrix();
  // Pairs before the horizon, of which the first stands for all, have a positive third coordinate.
  if (model.cur_H_ref.row(2).dot(pairs_[points[0]].ref.homogeneous()) < 0.0) {
    model.cur_H_ref = -model.cur_H_ref;
  }
  model.ref_H_cur = model.cur_H_ref.inverse();
  return true;
}

PLANECAST_VECTOR_CLONES
void HomographyModel::squared_residuals(const Parameters& model, int begin, int end,
                                        double* out) const {
  const Matrix3d h = model.cur_H_ref;
  const Matrix3d g = model.ref_H_cur;
  const double* const ref_x = ref_x_.data() + begin;
  const double* const ref_y = ref_y_.data() + begin;
  const double* const cur_x = cur_x_.data() + begin;
  const double* const cur_y = cur_y_.data() + begin;
  for (int i = 0; i < end - begin; ++i) {
    const double x = ref_x[i];
    const double y = ref_y[i];
    const double u = cur_x[i];
    const double v = cur_y[i];
    const double forward_w = h(2, 0) * x + h(2, 1) * y + h(2, 2);
    const double backward_w = g(2, 0) * u + g(2, 1) * v + g(2, 2);
    const double per_forward_w = 1.0 / forward_w;
    const double per_backward_w = 1.0 / backward_w;
    const double forward_x = (h(0, 0) * x + h(0, 1) * y + h(0, 2)) * per_forward_w - u;
    const double forward_y = (h(1, 0) * x + h(1, 1) * y + h(1, 2)) * per_forward_w - v;
    const double backward_x = (g(0, 0) * u + g(0, 1) * v + g(0, 2)) * per_backward_w - x;
    const double backward_y = (g(1, 0) * u + g(1, 1) * v + g(1, 2)) * per_backward_w - y;
    const double squared = 0.5 * (forward_x * forward_x + forward_y * forward_y +
                                  backward_x * backward_x + backward_y * backward_y);
    out[i] = std::min(forward_w, backward_w) > 0.0 ? squared : HUGE_VAL;
  }
}

}  // namespace planecast::slam
