#include "slam/geometry/relative_pose.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "slam/geometry/rotation.h"
#include "slam/geometry/triangulate.h"

namespace planecast::slam {
namespace {

constexpr int kIterations = 5;
constexpr int kMinPairs = 8;

using Matrix5 = Eigen::Matrix<double, 5, 5>;
using Vector5 = Eigen::Matrix<double, 5, 1>;

struct NormalEquations {
  Matrix5 hessian = Matrix5::Zero();
  Vector5 gradient = Vector5::Zero();
  double cost = 0.0;
  int pairs = 0;
};

NormalEquations accumulate(const SampsonModel& model, const std::vector<PointPair>& pairs,
                           const std::vector<char>& used, const Camera& camera) {
  NormalEquations equations;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!used[i]) continue;
    const SampsonTerm term = model.evaluate(camera.ray(pairs[i].ref), camera.ray(pairs[i].cur));
    equations.hessian.noalias() += term.jacobian.transpose() * term.jacobian;
    equations.gradient.noalias() += term.residual * term.jacobian.transpose();
    equations.cost += term.residual * term.residual;
    ++equations.pairs;
  }
  return equations;
}

}  // namespace

SampsonModel::SampsonModel(const Pose& cur_from_ref) : pose_(cur_from_ref) {
  const Eigen::Vector3d t = pose_.translation();
  tangent_.col(0) = t.unitOrthogonal();
  tangent_.col(1) = t.cross(tangent_.col(0)).normalized();
  essential_ = essential_from_pose(pose_);
  for (int k = 0; k < 3; ++k) {
    derivative_[k] = skew(t) * skew(Eigen::Vector3d::Unit(k)) * pose_.linear();
  }
  for (int k = 0; k < 2; ++k) derivative_[3 + k] = skew(tangent_.col(k)) * pose_.linear();
}

SampsonTerm SampsonModel::evaluate(const Eigen::Vector3d& ray_ref,
                                   const Eigen::Vector3d& ray_cur) const {
  const Eigen::Vector3d line_cur = essential_ * ray_ref;
  const Eigen::Vector2d n_cur = line_cur.head<2>();
  const Eigen::Vector2d n_ref = (essential_.transpose() * ray_cur).head<2>();
  const double algebraic = ray_cur.dot(line_cur);
  const double squared = n_cur.squaredNorm() + n_ref.squaredNorm();
  SampsonTerm term;
  term.jacobian.setZero();
  if (!(squared > 0.0)) return term;
  const double inverse = 1.0 / std::sqrt(squared);
  term.residual = algebraic * inverse;
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d d_line = derivative_[k] * ray_ref;
    const Eigen::Vector2d d_n_ref = (derivative_[k].transpose() * ray_cur).head<2>();
    const double d_squared = n_cur.dot(d_line.head<2>()) + n_ref.dot(d_n_ref);
    term.jacobian(k) = inverse * (ray_cur.dot(d_line) - algebraic * d_squared / squared);
  }
  return term;
}

Pose SampsonModel::stepped(const Vector5& step) const {
  Pose pose = Pose::Identity();
  pose.linear() = (rotation_exp(step.head<3>()) * Eigen::Quaterniond(pose_.linear()))
                      .normalized()
                      .toRotationMatrix();
  pose.translation() = (pose_.translation() + tangent_ * step.tail<2>()).normalized();
  return pose;
}

Pose refine_relative_pose(const Pose& cur_from_ref, const std::vector<PointPair>& pairs,
                          const std::vector<char>& used, const Camera& camera) {
  Pose best = cur_from_ref;
  SampsonModel model(best);
  NormalEquations equations = accumulate(model, pairs, used, camera);
  if (equations.pairs < kMinPairs) return best;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    // A trace of damping for scenes that leave a direction open, such as a rotation without
    // translation.
    equations.hessian.diagonal() *= 1.0 + 1e-9;
    const Vector5 step = -equations.hessian.ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    const Pose candidate = model.stepped(step);
    const SampsonModel next_model(candidate);
    const NormalEquations next = accumulate(next_model, pairs, used, camera);
    if (!(next.cost < equations.cost)) break;
    best = candidate;
    model = next_model;
    equations = next;
  }
  return best;
}

}  // namespace planecast::slam
