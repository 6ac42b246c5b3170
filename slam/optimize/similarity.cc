#include "slam/optimize/similarity.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "slam/geometry/rotation.h"

namespace planecast::slam {
namespace {

using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using PointJacobian = Eigen::Matrix<double, 3, 7>;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// d(exp(delta) p) / d delta at 0.
PointJacobian moved_point_jacobian(const Eigen::Vector3d& p) {
  PointJacobian jacobian;
  jacobian << -cross_matrix(p), Eigen::Matrix3d::Identity(), p;
  return jacobian;
}

Eigen::Matrix<double, 2, 3> projection_jacobian(const Camera& camera, const Eigen::Vector3d& p) {
  const double inverse_z = 1.0 / p.z();
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << camera.fx * inverse_z, 0.0, -camera.fx * p.x() * inverse_z * inverse_z, 0.0,
      camera.fy * inverse_z, -camera.fy * p.y() * inverse_z * inverse_z;
  return jacobian;
}

struct NormalEquations {
  Matrix7 hessian = Matrix7::Zero();
  Vector7 gradient = Vector7::Zero();
  double cost = 0.0;
};

NormalEquations build(const Camera& camera, const std::vector<SimilarityPair>& pairs,
                      const std::vector<char>& active, const Similarity& a_from_b,
                      double huber_chi2, double depth_sigma) {
  NormalEquations system;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (active[i] == 0) continue;
    SimilarityResidual residual;
    SimilarityJacobian jacobian;
    if (!similarity_residual(camera, pairs[i], a_from_b, depth_sigma, residual, jacobian)) {
      system.cost += 3.0 * huber_chi2;
      continue;
    }
    for (int part = 0; part < 3; ++part) {
      const auto r = residual.segment(2 * part, part < 2 ? 2 : 1);
      const auto j = jacobian.middleRows(2 * part, part < 2 ? 2 : 1);
      const double chi2 = r.squaredNorm();
      const double width = std::sqrt(huber_chi2);
      const bool inside = chi2 <= huber_chi2;
      const double weight = inside ? 1.0 : width / std::sqrt(chi2);
      system.cost += inside ? chi2 : 2.0 * width * std::sqrt(chi2) - huber_chi2;
      system.hessian += weight * j.transpose() * j;
      system.gradient += weight * j.transpose() * r;
    }
  }
  return system;
}

Similarity minimise(const Camera& camera, const std::vector<SimilarityPair>& pairs,
                    const std::vector<char>& active, Similarity similarity, double huber_chi2,
                    const SimilarityRefineOptions& options) {
  const int free = options.with_scale ? 7 : 6;
  double damping = 1e-4;
  NormalEquations system =
      build(camera, pairs, active, similarity, huber_chi2, options.depth_sigma);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    Matrix7 damped = system.hessian;
    damped.diagonal() *= 1.0 + damping;
    Vector7 step = Vector7::Zero();
    step.head(free) = -damped.topLeftCorner(free, free).ldlt().solve(system.gradient.head(free));
    if (!step.allFinite()) break;
    const Similarity moved = perturb_left(similarity, step);
    const NormalEquations next =
        build(camera, pairs, active, moved, huber_chi2, options.depth_sigma);
    if (!(next.cost < system.cost)) {
      damping *= 10.0;
      if (damping > 1e6) break;
      continue;
    }
    const bool settled = system.cost - next.cost < 1e-9 * system.cost;
    similarity = moved;
    system = next;
    damping = std::max(1e-9, 0.1 * damping);
    if (settled) break;
  }
  return similarity;
}

void choose_inliers(const Camera& camera, const std::vector<SimilarityPair>& pairs, double chi2,
                    SimilarityResult& result) {
  result.inlier.assign(pairs.size(), 0);
  result.num_inliers = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    result.inlier[i] = agrees(camera, pairs[i], result.a_from_b, chi2) ? 1 : 0;
    result.num_inliers += result.inlier[i];
  }
}

}  // namespace

bool similarity_residual(const Camera& camera, const SimilarityPair& pair,
                         const Similarity& a_from_b, double depth_sigma,
                         SimilarityResidual& residual, SimilarityJacobian& jacobian) {
  const Similarity b_from_a = a_from_b.inverse();
  const Eigen::Vector3d in_a = a_from_b * pair.point_b;
  const Eigen::Vector3d in_b = b_from_a * pair.point_a;
  if (in_a.z() <= 0.0 || in_b.z() <= 0.0 || pair.point_a.z() <= 0.0) return false;
  residual << (camera.project(in_a) - pair.pixel_a) / pair.sigma_a_px,
      (camera.project(in_b) - pair.pixel_b) / pair.sigma_b_px,
      std::log(in_a.z() / pair.point_a.z()) / depth_sigma;
  const PointJacobian moved_in_a = moved_point_jacobian(in_a);
  jacobian.topRows<2>() = projection_jacobian(camera, in_a) * moved_in_a / pair.sigma_a_px;
  jacobian.row(4) = moved_in_a.row(2) / (in_a.z() * depth_sigma);
  // The inverse of exp(delta) S takes a's point by S^-1 exp(-delta).
  jacobian.middleRows<2>(2) = -projection_jacobian(camera, in_b) *
                              (b_from_a.scale * b_from_a.rotation) *
                              moved_point_jacobian(pair.point_a) / pair.sigma_b_px;
  return true;
}

Similarity perturb_left(const Similarity& similarity, const Eigen::Matrix<double, 7, 1>& delta) {
  const Similarity step{std::exp(delta(6)), rotation_exp(delta.head<3>()).toRotationMatrix(),
                        delta.segment<3>(3)};
  return step * similarity;
}

SimilarityResult refine_similarity(const Camera& camera, const std::vector<SimilarityPair>& pairs,
                                   const Similarity& start,
                                   const SimilarityRefineOptions& options) {
  // Without the robust loss nothing that was chosen is weighed down.
  constexpr double kNoHuber = 1e12;
  SimilarityResult result;
  result.a_from_b = start;
  choose_inliers(camera, pairs, 4.0 * options.chi2, result);
  result.a_from_b = minimise(camera, pairs, result.inlier, result.a_from_b, options.chi2, options);
  choose_inliers(camera, pairs, options.chi2, result);
  if (result.num_inliers >= 3) {
    result.a_from_b = minimise(camera, pairs, result.inlier, result.a_from_b, kNoHuber, options);
    choose_inliers(camera, pairs, options.chi2, result);
  }
  return result;
}

}  // namespace planecast::slam
