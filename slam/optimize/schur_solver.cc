#include "slam/optimize/schur_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "slam/geometry/pose_system.h"

namespace planecast::slam {
namespace {

constexpr double kInitialDamping = 1e-5;
constexpr double kMaxDamping = 1e6;
/// A point behind a camera counts as a residual of this many times the threshold, without
/// direction.
constexpr double kBehindFactor = 1e4;

// Blocks are plain arrays with loops of fixed length, which the compiler turns into vectors; row by
// row.
using Block66 = std::array<double, 36>;
using Block36 = std::array<double, 18>;
using Block6 = std::array<double, 6>;

double robust_cost(double chi2, double threshold) {
  return chi2 <= threshold ? chi2 : 2.0 * std::sqrt(chi2 * threshold) - threshold;
}

/// Residual over sigma of one sight, and its derivatives by the pose's step and by the point.
struct Sight {
  int rows = 0;
  double residual[3];
  double by_pose[3][6];
  double by_point[3][3];

  double squared() const {
    double sum = 0.0;
    for (int k = 0; k < rows; ++k) sum += residual[k] * residual[k];
    return sum;
  }
};

/// Residuals alone; false for a point that is not in front of the camera.
bool look(const ReprojectionTerm& term, const Eigen::Vector3d& p, Sight& sight) {
  sight.rows = term.rows();
  if (!(p.z() > 0.0)) return false;
  const double inverse_z = 1.0 / p.z();
  const double s = term.inverse_sigma;
  sight.residual[0] = s * (term.fx * p.x() * inverse_z + term.cx - term.pixel.x());
  sight.residual[1] = s * (term.fy * p.y() * inverse_z + term.cy - term.pixel.y());
  if (sight.rows == 3) {
    sight.residual[2] = s * term.baseline_fx * (inverse_z - term.inverse_depth);
  }
  return true;
}

/// Derivatives. A step (omega, v) moves the point in the camera by omega x p + v, so that the
/// derivative of a residual with gradient g by p is (p x g, g).
void derive(const ReprojectionTerm& term, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& p,
            Sight& sight) {
  const double inverse_z = 1.0 / p.z();
  const double gx = term.inverse_sigma * term.fx * inverse_z;
  const double gxz = -gx * p.x() * inverse_z;
  const double gy = term.inverse_sigma * term.fy * inverse_z;
  const double gyz = -gy * p.y() * inverse_z;
  const double first[6] = {p.y() * gxz, p.z() * gx - p.x() * gxz, -p.y() * gx, gx, 0.0, gxz};
  const double second[6] = {p.y() * gyz - p.z() * gy, -p.x() * gyz, p.x() * gy, 0.0, gy, gyz};
  std::copy(first, first + 6, sight.by_pose[0]);
  std::copy(second, second + 6, sight.by_pose[1]);
  for (int i = 0; i < 3; ++i) {
    sight.by_point[0][i] = gx * rotation(0, i) + gxz * rotation(2, i);
    sight.by_point[1][i] = gy * rotation(1, i) + gyz * rotation(2, i);
  }
  if (sight.rows < 3) return;
  const double gz = -term.inverse_sigma * term.baseline_fx * inverse_z * inverse_z;
  const double third[6] = {p.y() * gz, -p.x() * gz, 0.0, 0.0, 0.0, gz};
  std::copy(third, third + 6, sight.by_pose[2]);
  for (int i = 0; i < 3; ++i) sight.by_point[2][i] = gz * rotation(2, i);
}

void scale(double factor, Sight& sight) {
  for (int k = 0; k < sight.rows; ++k) {
    sight.residual[k] *= factor;
    for (double& value : sight.by_pose[k]) value *= factor;
    for (double& value : sight.by_point[k]) value *= factor;
  }
}

/// block -= left^T * right, both 3 x 6.
void subtract_product(const Block36& left, const Block36& right, Block66& block) {
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t c = 0; c < 6; ++c) {
      block[6 * r + c] -=
          left[r] * right[c] + left[6 + r] * right[6 + c] + left[12 + r] * right[12 + c];
    }
  }
}

class Window {
 public:
  Window(BundleProblem& problem, bool robust) : problem_(problem), robust_(robust) {
    for (const PoseBlock& block : problem.poses) poses_.push_back(pose_from_block(block));
    points_ = problem.points;
    int next = 0;
    for (const char fixed : problem.fixed) slot_.push_back(fixed != 0 ? kNone : next++);
    free_ = static_cast<std::size_t>(next);
    for (const BundleObservation& seen : problem.observations) {
      if (seen.active) active_.push_back(&seen);
    }
    cross_.resize(active_.size());
    elimination_.resize(points_.size());
  }

  double cost(const std::vector<Pose>& poses, const std::vector<Eigen::Vector3d>& points) const {
    double sum = 0.0;
    Sight sight;
    for (const BundleObservation* seen : active_) {
      const Pose& pose = poses[static_cast<std::size_t>(seen->pose)];
      const bool in_front =
          look(seen->term, pose * points[static_cast<std::size_t>(seen->point)], sight);
      const double threshold = problem_.threshold(*seen);
      const double chi2 = in_front ? sight.squared() : kBehindFactor * threshold;
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

  /// Adds one sight to the normal equations; gives its block between point and pose.
  void add(const BundleObservation& seen, Eigen::Matrix3d& point_hessian,
           Eigen::Vector3d& point_gradient, Block36& cross) {
    const auto p = static_cast<std::size_t>(seen.pose);
    const Eigen::Matrix3d rotation = poses_[p].linear();
    const Eigen::Vector3d in_camera =
        rotation * points_[static_cast<std::size_t>(seen.point)] + poses_[p].translation();
    cross.fill(0.0);
    Sight sight;
    if (!look(seen.term, in_camera, sight)) return;
    derive(seen.term, rotation, in_camera, sight);
    const double threshold = problem_.threshold(seen);
    const double chi2 = sight.squared();
    if (robust_ && chi2 > threshold) scale(std::sqrt(std::sqrt(threshold / chi2)), sight);

    for (int k = 0; k < sight.rows; ++k) {
      const double* by_point = sight.by_point[k];
      for (int i = 0; i < 3; ++i) {
        point_gradient[i] += by_point[i] * sight.residual[k];
        for (int j = 0; j < 3; ++j) point_hessian(i, j) += by_point[i] * by_point[j];
      }
    }
    const int slot = slot_[p];
    if (slot == kNone) return;
    Block66& hessian = hessian_[static_cast<std::size_t>(slot)];
    Block6& gradient = gradient_[static_cast<std::size_t>(slot)];
    for (int k = 0; k < sight.rows; ++k) {
      const double* by_pose = sight.by_pose[k];
      for (std::size_t r = 0; r < 6; ++r) {
        gradient[r] += by_pose[r] * sight.residual[k];
        for (std::size_t c = 0; c < 6; ++c) hessian[6 * r + c] += by_pose[r] * by_pose[c];
      }
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 6; ++c) cross[6 * i + c] += sight.by_point[k][i] * by_pose[c];
      }
    }
  }

  /// The sights begin..end of one point.
  void eliminate(std::size_t begin, std::size_t end, double damping) {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (std::size_t i = begin; i < end; ++i) add(*active_[i], hessian, gradient, cross_[i]);
    hessian.diagonal() *= 1.0 + damping;
    // A point that nothing determines stays where it is.
    hessian.diagonal().array() += 1e-12;
    Elimination& elimination = elimination_[static_cast<std::size_t>(active_[begin]->point)];
    elimination.inverse_hessian = hessian.inverse();
    elimination.gradient = gradient;
    const Eigen::Vector3d moved = elimination.inverse_hessian * gradient;
    for (std::size_t i = begin; i < end; ++i) {
      const int row = slot_[static_cast<std::size_t>(active_[i]->pose)];
      if (row == kNone) continue;
      const auto r = static_cast<std::size_t>(row);
      Block36 eliminated = {};
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t c = 0; c < 6; ++c) {
          gradient_[r][c] -= moved[static_cast<Eigen::Index>(k)] * cross_[i][6 * k + c];
          for (std::size_t m = 0; m < 3; ++m) {
            eliminated[6 * m + c] += elimination.inverse_hessian(static_cast<Eigen::Index>(m),
                                                                 static_cast<Eigen::Index>(k)) *
                                     cross_[i][6 * k + c];
          }
        }
      }
      for (std::size_t j = i; j < end; ++j) {
        const int column = slot_[static_cast<std::size_t>(active_[j]->pose)];
        if (column == kNone) continue;
        // Observations of a landmark ascend by keyframe, so that this is the upper triangle.
        subtract_product(eliminated, cross_[j],
                         reduced_[r * free_ + static_cast<std::size_t>(column)]);
      }
    }
  }

  /// End of the sights of the point whose sights begin there.
  std::size_t end_of_point(std::size_t begin) const {
    std::size_t end = begin + 1;
    while (end < active_.size() && active_[end]->point == active_[begin]->point) ++end;
    return end;
  }

  /// The steps of the free poses from the reduced system; false where it has no solution.
  bool solve_poses(double damping) {
    const auto size = static_cast<Eigen::Index>(6 * free_);
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient(size);
    for (std::size_t row = 0; row < free_; ++row) {
      for (std::size_t column = row; column < free_; ++column) {
        using Map66 = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>;
        auto block = system.block<6, 6>(static_cast<Eigen::Index>(6 * row),
                                        static_cast<Eigen::Index>(6 * column));
        block = Map66(reduced_[row * free_ + column].data());
        if (row != column) continue;
        block += Map66(hessian_[row].data());
        // A pose that nothing determines stays where it is.
        block.diagonal() += damping * Map66(hessian_[row].data()).diagonal();
        block.diagonal().array() += 1e-9;
      }
      gradient.segment<6>(static_cast<Eigen::Index>(6 * row)) =
          Eigen::Map<const Eigen::Matrix<double, 6, 1>>(gradient_[row].data());
    }
    solution_ = -system.selfadjointView<Eigen::Upper>().ldlt().solve(gradient);
    return solution_.allFinite();
  }

  /// Fills next_poses_ and next_points_; false where the system has no solution.
  bool step(double damping) {
    hessian_.assign(free_, Block66{});
    gradient_.assign(free_, Block6{});
    reduced_.assign(free_ * free_, Block66{});
    for (std::size_t begin = 0; begin < active_.size();) {
      const std::size_t end = end_of_point(begin);
      eliminate(begin, end, damping);
      begin = end;
    }
    next_poses_ = poses_;
    next_points_ = points_;
    if (free_ > 0) {
      if (!solve_poses(damping)) return false;
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        if (slot_[i] != kNone)
          next_poses_[i] = stepped(poses_[i], solution_.segment<6>(6 * slot_[i]));
      }
    }
    for (std::size_t begin = 0; begin < active_.size();) {
      const std::size_t end = end_of_point(begin);
      const auto point = static_cast<std::size_t>(active_[begin]->point);
      Eigen::Vector3d gradient = elimination_[point].gradient;
      for (std::size_t i = begin; i < end; ++i) {
        const int slot = slot_[static_cast<std::size_t>(active_[i]->pose)];
        if (slot == kNone) continue;
        using Map36 = Eigen::Map<const Eigen::Matrix<double, 3, 6, Eigen::RowMajor>>;
        gradient.noalias() += Map36(cross_[i].data()) * solution_.segment<6>(6 * slot);
      }
      next_points_[point] -= elimination_[point].inverse_hessian * gradient;
      begin = end;
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
  std::size_t free_ = 0;
  std::vector<const BundleObservation*> active_;
  std::vector<Block36> cross_;  ///< per active observation; zero where its pose is fixed
  std::vector<Elimination> elimination_;
  std::vector<Block66> hessian_;  ///< per free pose
  std::vector<Block6> gradient_;  ///< per free pose
  std::vector<Block66> reduced_;  ///< per pair of free poses, row by row; upper triangle
  Eigen::VectorXd solution_;
};

}  // namespace

int solve_window(BundleProblem& problem, const SchurOptions& options) {
  return Window(problem, options.robust).minimise(options);
}

}  // namespace planecast::slam
