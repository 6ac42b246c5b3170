#include "slam/optimize/similarity_cost.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "slam/geometry/rotation.h"

namespace planecast::slam {
namespace {

using Jacobian = Eigen::Matrix<double, 7, 8, Eigen::RowMajor>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation) {
  const Eigen::Quaterniond q =
      rotation.w() < 0.0 ? Eigen::Quaterniond(-rotation.coeffs()) : rotation;
  const double sine = q.vec().norm();
  // atan2(sine, w) / sine; its series where the quotient loses digits.
  const double factor =
      sine < 1e-5 ? 2.0 * (1.0 + sine * sine / 6.0) : 2.0 * std::atan2(sine, q.w()) / sine;
  return factor * q.vec();
}

/// d Log(exp(omega) R) / d omega at 0, for Log(R) = phi, |phi| < pi.
Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& phi) {
  const double angle2 = phi.squaredNorm();
  const double angle = std::sqrt(angle2);
  const double factor =
      angle < 1e-2 ? 1.0 / 12.0 + angle2 / 720.0
                   : 1.0 / angle2 - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  const Eigen::Matrix3d cross = cross_matrix(phi);
  return Eigen::Matrix3d::Identity() - 0.5 * cross + factor * cross * cross;
}

/// S exp(delta) = exp(adjoint(S) delta) S, to first order.
Matrix7 adjoint(const Similarity& s) {
  Matrix7 m = Matrix7::Zero();
  m.block<3, 3>(0, 0) = s.rotation;
  m.block<3, 3>(3, 0) = cross_matrix(s.translation) * s.rotation;
  m.block<3, 3>(3, 3) = s.scale * s.rotation;
  m.block<3, 1>(3, 6) = -s.translation;
  m(6, 6) = 1.0;
  return m;
}

/// Derivative of (Log rotation, translation, ln scale) of exp(eta) E by eta.
Matrix7 error_jacobian(const Similarity& error, const Eigen::Vector3d& phi) {
  Matrix7 m = Matrix7::Zero();
  m.block<3, 3>(0, 0) = left_jacobian_inverse(phi);
  m.block<3, 3>(3, 0) = -cross_matrix(error.translation);
  m.block<3, 3>(3, 3).setIdentity();
  m.block<3, 1>(3, 6) = error.translation;
  m(6, 6) = 1.0;
  return m;
}

}  // namespace

SimilarityBlock block_from_similarity(const Similarity& similarity) {
  const Eigen::Quaterniond q(similarity.rotation);
  const Eigen::Vector3d& t = similarity.translation;
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z(), std::log(similarity.scale)};
}

Similarity similarity_from_block(const double* block) {
  const Eigen::Quaterniond q(block[3], block[0], block[1], block[2]);
  return {std::exp(block[7]), q.normalized().toRotationMatrix(),
          Eigen::Vector3d(block[4], block[5], block[6])};
}

bool SimilarityManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Map<const Eigen::Vector3d> omega(delta);
  const Eigen::Map<const Eigen::Vector3d> v(delta + 3);
  const double log_scale = tangent_ == 7 ? delta[6] : 0.0;
  const Eigen::Quaterniond turn = rotation_exp(omega);
  const Eigen::Quaterniond q = turn * Eigen::Quaterniond(x[3], x[0], x[1], x[2]);
  const Eigen::Vector3d t = std::exp(log_scale) * (turn * Eigen::Vector3d(x[4], x[5], x[6])) + v;
  Eigen::Map<Eigen::Vector4d>{x_plus_delta} = q.normalized().coeffs();
  Eigen::Map<Eigen::Vector3d>{x_plus_delta + 4} = t;
  x_plus_delta[7] = x[7] + log_scale;
  return true;
}

bool SimilarityManifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
  std::fill_n(jacobian, 8 * tangent_, 0.0);
  for (int i = 0; i < tangent_; ++i) jacobian[i * tangent_ + i] = 1.0;
  return true;
}

bool SimilarityManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Eigen::Quaterniond qy(y[3], y[0], y[1], y[2]);
  const Eigen::Quaterniond qx(x[3], x[0], x[1], x[2]);
  const Eigen::Quaterniond turn = (qy * qx.conjugate()).normalized();
  const double log_scale = tangent_ == 7 ? y[7] - x[7] : 0.0;
  Eigen::Map<Eigen::Vector3d>{y_minus_x} = rotation_log(turn);
  Eigen::Map<Eigen::Vector3d>{y_minus_x + 3} =
      Eigen::Vector3d(y[4], y[5], y[6]) -
      std::exp(log_scale) * (turn * Eigen::Vector3d(x[4], x[5], x[6]));
  if (tangent_ == 7) y_minus_x[6] = log_scale;
  return true;
}

bool SimilarityManifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
  std::fill_n(jacobian, 8 * tangent_, 0.0);
  for (int i = 0; i < tangent_; ++i) jacobian[i * 8 + i] = 1.0;
  return true;
}

bool SimilarityEdgeCost::Evaluate(double const* const* parameters, double* residuals,
                                  double** jacobians) const {
  const Similarity from = similarity_from_block(parameters[0]);
  const Similarity to = similarity_from_block(parameters[1]);
  const Similarity error = to_from_from_ * from * to.inverse();
  const Eigen::Vector3d phi = rotation_log(Eigen::Quaterniond(error.rotation));
  Eigen::Matrix<double, 7, 1> row_weight = Eigen::Matrix<double, 7, 1>::Constant(weight_);
  row_weight.segment<3>(3) /= length_;
  Eigen::Map<Eigen::Matrix<double, 7, 1>> r(residuals);
  r << phi, error.translation, std::log(error.scale);
  r = r.cwiseProduct(row_weight).eval();
  if (jacobians == nullptr) return true;
  const Matrix7 by_error = row_weight.asDiagonal() * error_jacobian(error, phi);
  if (jacobians[0] != nullptr) {
    Eigen::Map<Jacobian> j(jacobians[0]);
    j.leftCols<7>() = by_error * adjoint(to_from_from_);
    j.col(7).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Jacobian> j(jacobians[1]);
    j.leftCols<7>() = -by_error * adjoint(error);
    j.col(7).setZero();
  }
  return true;
}

}  // namespace planecast::slam
