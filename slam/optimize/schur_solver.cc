#include "slam/optimize/schur_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "slam/geometry/pose_system.h"

namespace planecast::slam {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

constexpr double kInitialDamping = 1e-5;
constexpr double kMaxDamping = 1e6;
/// A point behind a camera counts as a residual of this many times the threshold, without
/// direction.
constexpr double kBehindFactor = 1e4;

double robust_cost(double chi2, double threshold) {
  return chi2 <= threshold ? chi2 : 2.0 * std::sqrt(chi2 * threshold) - threshold;
}

/// Residual over sigma of one sight with its derivatives by the point in the camera.
struct Sight {
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();
  double gx = 0.0, gxz = 0.0;  ///< first row: (gx, 0, gxz)
  double gy = 0.0, gyz = 0.0;  ///< second row: (0, gy, gyz)
  double gz = 0.0;             ///< third row: (0, 0, gz)
  bool depth = false;
  bool in_front = false;
};

Sight look(const ReprojectionTerm& term, const Eigen::Vector3d& p) {
  Sight sight;
  sight.depth = term.inverse_depth > 0.0;
  if (!(p.z() > 0.0)) return sight;
  sight.in_front = true;
  const double inverse_z = 1.0 / p.z();
  const double x = p.x() * inverse_z;
  const double y = p.y() * inverse_z;
  const double s = term.inverse_sigma;
  sight.residual.x() = s * (term.fx * x + term.cx - term.pixel.x());
  sight.residual.y() = s * (term.fy * y + term.cy - term.pixel.y());
  sight.gx = s * term.fx * inverse_z;
  sight.gxz = -sight.gx * x;
  sight.gy = s * term.fy * inverse_z;
  sight.gyz = -sight.gy * y;
  if (sight.depth) {
    sight.residual.z() = s * term.baseline_fx * (inverse_z - term.inverse_depth);
    sight.gz = -s * term.baseline_fx * inverse_z * inverse_z;
  }
  return sight;
}

class Window {
 public:
  Window(BundleProblem& problem, bool robust) : problem_(problem), robust_(robust) {
    for (const PoseBlock& block : problem.poses) poses_.push_back(pose_from_block(block));
    points_ = problem.points;
    int next = 0;
    for (const char fixed : problem.fixed) slot_.push_back(fixed != 0 ? kNone : next++);
    free_ = next;
    cross_.resize(problem.observations.size());
    elimination_.resize(points_.size());
  }

  double cost(const std::vector<Pose>& poses, const std::vector<Eigen::Vector3d>& points) const {
    double sum = 0.0;
    for (const BundleObservation& seen : problem_.observations) {
      if (!seen.active) continue;
      const Pose& pose = poses[static_cast<std::size_t>(seen.pose)];
      const Sight sight = look(seen.term, pose * points[static_cast<std::size_t>(seen.point)]);
      const double threshold = problem_.threshold(seen);
      const double chi2 = sight.in_front ? sight.residual.squaredNorm() : kBehindFactor * threshold;
      sum += robust_ ? robust_cost(chi2, threshold) : chi2;
    }
    return sum;
  }

  int minimise(const SchurOptions& options) {
    double now = cost(poses_, points_);
    double damping = kInitialDamping;
    int iteration = 0;
    while (iteration < options.iterations && damping < kMaxDamping) {
      ++iteration;
      if (!step(damping)) {
        damping = std::max(10.0 * damping, 1e-3);
        continue;
      }
      const double next = cost(next_poses_, next_points_);
      if (!(next < now)) {
        if (next <= now * (1.0 + options.function_tolerance)) break;
        damping = std::max(10.0 * damping, 1e-3);
        continue;
      }
      poses_.swap(next_poses_);
      points_.swap(next_points_);
      const bool converged = now - next < options.function_tolerance * now;
      now = next;
      damping = std::max(0.1 * damping, 1e-9);
      if (converged) break;
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (slot_[i] != kNone) problem_.poses[i] = block_from_pose(poses_[i]);
    }
    problem_.points = points_;
    return iteration;
  }

 private:
  /// What is left of a point after its elimination.
  struct Elimination {
    Eigen::Matrix3d inverse_hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  };

  /// Adds one sight to the normal equations; returns its block between pose and point.
  void add(const BundleObservation& seen, Eigen::Matrix3d& point_hessian,
           Eigen::Vector3d& point_gradient, Matrix63& cross) {
    const auto p = static_cast<std::size_t>(seen.pose);
    const Pose& pose = poses_[p];
    const Eigen::Matrix3d rotation = pose.linear();
    const Eigen::Vector3d in_camera =
        rotation * points_[static_cast<std::size_t>(seen.point)] + pose.translation();
    const Sight sight = look(seen.term, in_camera);
    cross.setZero();
    if (!sight.in_front) return;
    const double threshold = problem_.threshold(seen);
    const double chi2 = sight.residual.squaredNorm();
    const double weight = robust_ && chi2 > threshold ? std::sqrt(threshold / chi2) : 1.0;

    // By the point in the camera: A = G^T w G and b = G^T w r, from which all blocks follow.
    Eigen::Matrix3d a;
    a(0, 0) = sight.gx * sight.gx;
    a(0, 1) = a(1, 0) = 0.0;
    a(0, 2) = a(2, 0) = sight.gx * sight.gxz;
    a(1, 1) = sight.gy * sight.gy;
    a(1, 2) = a(2, 1) = sight.gy * sight.gyz;
    a(2, 2) = sight.gxz * sight.gxz + sight.gyz * sight.gyz + sight.gz * sight.gz;
    a *= weight;
    const Eigen::Vector3d b =
        weight * Eigen::Vector3d(sight.gx * sight.residual.x(), sight.gy * sight.residual.y(),
                                 sight.gxz * sight.residual.x() + sight.gyz * sight.residual.y() +
                                     sight.gz * sight.residual.z());
    const Eigen::Matrix3d a_rotation = a * rotation;
    point_hessian.noalias() += rotation.transpose() * a_rotation;
    point_gradient.noalias() += rotation.transpose() * b;
    const int slot = slot_[p];
    if (slot == kNone) return;

    // A step (omega, v) moves the point in the camera by omega x p + v = -[p]x omega + v.
    Eigen::Matrix3d hat;
    hat << 0.0, -in_camera.z(), in_camera.y(), in_camera.z(), 0.0, -in_camera.x(), -in_camera.y(),
        in_camera.x(), 0.0;
    const Eigen::Matrix3d hat_a = hat * a;  // ([-p]x)^T = [p]x
    auto pose_hessian = hessian_.block<6, 6>(6 * slot, 6 * slot);
    pose_hessian.topLeftCorner<3, 3>().noalias() -= hat_a * hat;
    pose_hessian.topRightCorner<3, 3>() += hat_a;
    pose_hessian.bottomLeftCorner<3, 3>() += hat_a.transpose();
    pose_hessian.bottomRightCorner<3, 3>() += a;
    auto pose_gradient = gradient_.segment<6>(6 * slot);
    pose_gradient.head<3>() += in_camera.cross(b);
    pose_gradient.tail<3>() += b;
    cross.topRows<3>().noalias() = hat * a_rotation;
    cross.bottomRows<3>() = a_rotation;
  }

  void eliminate(std::size_t begin, std::size_t end, double damping) {
    const auto point = static_cast<std::size_t>(problem_.observations[begin].point);
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (std::size_t i = begin; i < end; ++i) {
      const BundleObservation& seen = problem_.observations[i];
      if (seen.active) add(seen, hessian, gradient, cross_[i]);
    }
    hessian.diagonal() *= 1.0 + damping;
    // A point that nothing determines stays where it is.
    hessian.diagonal().array() += 1e-12;
    Elimination& elimination = elimination_[point];
    elimination.inverse_hessian = hessian.inverse();
    elimination.gradient = gradient;
    const Eigen::Vector3d moved = elimination.inverse_hessian * gradient;
    for (std::size_t i = begin; i < end; ++i) {
      const BundleObservation& first = problem_.observations[i];
      const int row = slot_[static_cast<std::size_t>(first.pose)];
      if (!first.active || row == kNone) continue;
      const Matrix63 eliminated = cross_[i] * elimination.inverse_hessian;
      gradient_.segment<6>(6 * row).noalias() -= cross_[i] * moved;
      for (std::size_t j = i; j < end; ++j) {
        const BundleObservation& second = problem_.observations[j];
        const int column = slot_[static_cast<std::size_t>(second.pose)];
        if (!second.active || column == kNone) continue;
        // Observations of a landmark ascend by keyframe, so that this is the upper triangle.
        reduced_.block<6, 6>(6 * row, 6 * column).noalias() -= eliminated * cross_[j].transpose();
      }
    }
  }

  /// Fills next_poses_ and next_points_; false where the system has no solution.
  bool step(double damping) {
    hessian_ = Eigen::MatrixXd::Zero(6 * free_, 6 * free_);
    reduced_ = Eigen::MatrixXd::Zero(6 * free_, 6 * free_);
    gradient_ = Eigen::VectorXd::Zero(6 * free_);
    const std::vector<BundleObservation>& all = problem_.observations;
    for (std::size_t begin = 0; begin < all.size();) {
      std::size_t end = begin + 1;
      while (end < all.size() && all[end].point == all[begin].point) ++end;
      eliminate(begin, end, damping);
      begin = end;
    }
    next_poses_ = poses_;
    next_points_ = points_;
    if (free_ > 0) {
      hessian_.diagonal() *= 1.0 + damping;
      // A pose that nothing determines stays where it is.
      hessian_.diagonal().array() += 1e-9;
      reduced_ += hessian_;
      solution_ = -reduced_.selfadjointView<Eigen::Upper>().ldlt().solve(gradient_);
      if (!solution_.allFinite()) return false;
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        if (slot_[i] != kNone)
          next_poses_[i] = stepped(poses_[i], solution_.segment<6>(6 * slot_[i]));
      }
    }
    for (std::size_t begin = 0; begin < all.size();) {
      const auto point = static_cast<std::size_t>(all[begin].point);
      Eigen::Vector3d gradient = elimination_[point].gradient;
      std::size_t i = begin;
      for (; i < all.size() && all[i].point == all[begin].point; ++i) {
        const int slot = slot_[static_cast<std::size_t>(all[i].pose)];
        if (!all[i].active || slot == kNone) continue;
        gradient.noalias() += cross_[i].transpose() * solution_.segment<6>(6 * slot);
      }
      next_points_[point] -= elimination_[point].inverse_hessian * gradient;
      begin = i;
    }
    return true;
  }

  BundleProblem& problem_;
  bool robust_;
  std::vector<Pose> poses_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Pose> next_poses_;
  std::vector<Eigen::Vector3d> next_points_;
  std::vector<int> slot_;  ///< per pose, among the free ones; kNone = fixed
  int free_ = 0;
  std::vector<Matrix63> cross_;  ///< per observation
  std::vector<Elimination> elimination_;
  Eigen::MatrixXd hessian_;
  Eigen::MatrixXd reduced_;
  Eigen::VectorXd gradient_;
  Eigen::VectorXd solution_;
};

}  // namespace

int solve_window(BundleProblem& problem, const SchurOptions& options) {
  return Window(problem, options.robust).minimise(options);
}

}  // namespace planecast::slam
