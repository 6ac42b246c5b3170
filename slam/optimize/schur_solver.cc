#include "slam/optimize/schur_solver.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "slam/geometry/pose_system.h"
#include "slam/optimize/point_elimination.h"

namespace planecast::slam {
namespace {

constexpr double kInitialDamping = 1e-5;
/// What the single precision of the poses' blocks leaves unsure must not be taken for known.
constexpr double kLeastDamping = 1e-6;
constexpr double kMaxDamping = 1e6;
/// A point behind a camera counts as a residual of this many times the threshold, without
/// direction.
constexpr double kBehindFactor = 1e4;

/// Sum of the logarithms of factors of 1 and more, of which few are taken: they are most of a
/// sight's cost.
class LogarithmSum {
 public:
  void add(double factor) {
    product_ *= factor;
    if (product_ < kMost) return;
    sum_ += std::log(product_);
    product_ = 1.0;
  }
  double total() const { return sum_ + std::log(product_); }

 private:
  static constexpr double kMost = 1e200;
  double product_ = 1.0;
  double sum_ = 0.0;
};

/// An active observation, without what all share.
struct Sight {
  int pose = 0;
  int point = 0;
  int rows = 2;
  Eigen::Vector2d pixel;
  double inverse_sigma = 0.0;
  double inverse_depth = 0.0;
  double threshold = 0.0;
  double width2 = 0.0;          ///< see robust_cost()
  double inverse_width2 = 0.0;  ///< 1 / width2
};

/// A state of the poses and points that are looked for.
struct State {
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;
};

class Window {
 public:
  Window(BundleProblem& problem, const SchurOptions& options)
      : problem_(problem),
        loss_(options.loss),
        width2_mono_(bend_of(loss_, options.spread, problem.chi2_mono, false)),
        width2_depth_(bend_of(loss_, options.spread, problem.chi2_depth, true)),
        pose_variance_(std::min(options.spread.mono, options.spread.depth)),
        elimination_(count_free(problem)) {
    for (const PoseBlock& block : problem.poses) now_.poses.push_back(pose_from_block(block));
    now_.points = problem.points;
    int next = 0;
    for (const char fixed : problem.fixed) slot_.push_back(fixed != 0 ? kNone : next++);
    sights_.reserve(problem.observations.size());
    for (const BundleObservation& seen : problem.observations) {
      if (seen.active) add(seen);
    }
    point_begin_.push_back(sights_.size());
    derivatives_.resize(most_sights());
    cross_.resize(sights_.size());
    points_.resize(point_begin_.size() - 1);
  }

  int minimise(const SchurOptions& options) {
    double now = cost(now_);
    double damping = kInitialDamping;
    int iteration = 0;
    while (iteration < options.iterations && damping < kMaxDamping) {
      ++iteration;
      if (!step(damping)) {
        damping = std::max(10.0 * damping, 1e-3);
        continue;
      }
      const double next = cost(next_);
      if (!(next < now)) {
        if (next <= now * (1.0 + options.function_tolerance)) break;
        damping = std::max(10.0 * damping, 1e-3);
        continue;
      }
      std::swap(now_, next_);
      // A decrease as large as foretold ends at the minimum of what the equations describe.
      const double decrease = now - next;
      const double left = loss_ == RobustLoss::kSquared
                              ? std::abs(elimination_.expected_decrease() - decrease)
                              : decrease;
      const bool converged = std::min(decrease, left) < options.function_tolerance * now ||
                             has_settled(options.pose_tolerance);
      now = next;
      damping = std::max(0.1 * damping, kLeastDamping);
      if (converged) break;
    }
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (slot_[i] != kNone) problem_.poses[i] = block_from_pose(now_.poses[i]);
    }
    problem_.points = now_.points;
    return iteration;
  }

 private:
  /// Whether the last step was a small one for the poses.
  bool has_settled(double tolerance) const {
    const double moved = elimination_.pose_decrease();
    const double freedom = 6.0 * static_cast<double>(count_free(problem_));
    return loss_ == RobustLoss::kCauchy && moved < tolerance * freedom * pose_variance_;
  }

  static std::size_t count_free(const BundleProblem& problem) {
    return static_cast<std::size_t>(std::count(problem.fixed.begin(), problem.fixed.end(), 0));
  }

  void add(const BundleObservation& seen) {
    // One camera took all keyframes.
    camera_ = seen.term;
    if (sights_.empty() || sights_.back().point != seen.point) {
      point_begin_.push_back(sights_.size());
    }
    const double threshold = problem_.threshold(seen);
    const double width2 = seen.term.rows() == 3 ? width2_depth_ : width2_mono_;
    sights_.push_back({seen.pose, seen.point, seen.term.rows(), seen.term.pixel,
                       seen.term.inverse_sigma, seen.term.inverse_depth, threshold, width2,
                       1.0 / width2});
    slots_.push_back(slot_[static_cast<std::size_t>(seen.pose)]);
  }

  std::size_t most_sights() const {
    std::size_t most = 0;
    for (std::size_t p = 0; p + 1 < point_begin_.size(); ++p) {
      most = std::max(most, point_begin_[p + 1] - point_begin_[p]);
    }
    return most;
  }

  /// Residuals over sigma; false for a point that is not in front of the camera.
  bool look(const Sight& sight, const Eigen::Vector3d& p, double (&residual)[3]) const {
    if (!(p.z() > 0.0)) return false;
    const double inverse_z = 1.0 / p.z();
    const double s = sight.inverse_sigma;
    residual[0] = s * (camera_.fx * p.x() * inverse_z + camera_.cx - sight.pixel.x());
    residual[1] = s * (camera_.fy * p.y() * inverse_z + camera_.cy - sight.pixel.y());
    if (sight.rows == 3) {
      residual[2] = s * camera_.baseline_fx * (inverse_z - sight.inverse_depth);
    }
    return true;
  }

  double cost(const State& state) const {
    double sum = 0.0;
    LogarithmSum mono, depth;  // of Cauchy, by width
    double residual[3];
    for (const Sight& sight : sights_) {
      const Pose& pose = state.poses[static_cast<std::size_t>(sight.pose)];
      const Eigen::Vector3d p = pose * state.points[static_cast<std::size_t>(sight.point)];
      double chi2 = kBehindFactor * sight.threshold;
      if (look(sight, p, residual)) {
        chi2 = residual[0] * residual[0] + residual[1] * residual[1];
        if (sight.rows == 3) chi2 += residual[2] * residual[2];
      }
      if (loss_ == RobustLoss::kCauchy) {
        (sight.rows == 3 ? depth : mono).add(1.0 + chi2 * sight.inverse_width2);
      } else {
        sum += robust_cost(loss_, chi2, sight.width2);
      }
    }
    return sum + width2_mono_ * mono.total() + width2_depth_ * depth.total();
  }

  /// A step (omega, v) moves the point in the camera by omega x p + v, so that the derivative of a
  /// residual with gradient g by p is (p x g, g).
  void derive(std::size_t s, SightDerivatives& d) const {
    const Sight& sight = sights_[s];
    const Pose& pose = now_.poses[static_cast<std::size_t>(sight.pose)];
    const Eigen::Vector3d p = pose * now_.points[static_cast<std::size_t>(sight.point)];
    d.slot = slots_[s];
    d.rows = 0;
    if (!look(sight, p, d.residual)) return;
    d.rows = sight.rows;
    double chi2 = 0.0;
    for (int k = 0; k < d.rows; ++k) chi2 += d.residual[k] * d.residual[k];
    const double weight = std::sqrt(robust_weight(loss_, chi2, sight.width2));
    for (int k = 0; k < d.rows; ++k) d.residual[k] *= weight;
    const double inverse_z = 1.0 / p.z();
    const double s_z = weight * sight.inverse_sigma * inverse_z;
    const double gx = s_z * camera_.fx;
    const double gxz = -gx * p.x() * inverse_z;
    const double gy = s_z * camera_.fy;
    const double gyz = -gy * p.y() * inverse_z;
    const double gz = d.rows == 3 ? -s_z * camera_.baseline_fx * inverse_z : 0.0;
    const auto& rotation = pose.linear();
    for (int i = 0; i < 3; ++i) {
      d.by_point[0][i] = gx * rotation(0, i) + gxz * rotation(2, i);
      d.by_point[1][i] = gy * rotation(1, i) + gyz * rotation(2, i);
    }
    for (int i = 0; i < 3; ++i) d.by_point[2][i] = gz * rotation(2, i);
    if (d.slot == kNone) return;
    set(d.by_pose[0], p.y() * gxz, p.z() * gx - p.x() * gxz, -p.y() * gx, gx, 0.0, gxz);
    set(d.by_pose[1], p.y() * gyz - p.z() * gy, -p.x() * gyz, p.x() * gy, 0.0, gy, gyz);
    if (d.rows == 3) set(d.by_pose[2], p.y() * gz, -p.x() * gz, 0.0, 0.0, 0.0, gz);
  }

  static void set(double (&row)[6], double a, double b, double c, double d, double e, double f) {
    const double values[6] = {a, b, c, d, e, f};
    std::copy(values, values + 6, row);
  }

  /// Fills next_; false where the system has no solution.
  bool step(double damping) {
    elimination_.begin(damping);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const std::size_t begin = point_begin_[p];
      const std::size_t count = point_begin_[p + 1] - begin;
      for (std::size_t i = 0; i < count; ++i) derive(begin + i, derivatives_[i]);
      elimination_.add_point(derivatives_.data(), count, cross_.data() + begin, points_[p]);
    }
    if (!elimination_.solve()) return false;
    next_ = now_;
    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (slot_[i] != kNone) {
        next_.poses[i] = stepped(now_.poses[i], elimination_.step(slot_[i]));
      }
    }
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const std::size_t begin = point_begin_[p];
      next_.points[static_cast<std::size_t>(sights_[begin].point)] += elimination_.point_step(
          points_[p], slots_.data() + begin, cross_.data() + begin, point_begin_[p + 1] - begin);
    }
    return true;
  }

  BundleProblem& problem_;
  RobustLoss loss_;
  double width2_mono_;    ///< where the loss bends
  double width2_depth_;   ///< the same for sights with depth
  double pose_variance_;  ///< in the units of the sum of squares
  PointElimination elimination_;
  ReprojectionTerm camera_ = ReprojectionTerm({}, 0.0, Eigen::Vector2d::Zero(), 1.0, 0.0);
  State now_;
  State next_;
  std::vector<int> slot_;                 ///< per pose, among the free ones; kNone = fixed
  std::vector<Sight> sights_;             ///< by point
  std::vector<int> slots_;                ///< per sight
  std::vector<std::size_t> point_begin_;  ///< of each point's sights, and where the last ones end
  std::vector<SightDerivatives> derivatives_;    ///< of the point at hand
  std::vector<PointElimination::Cross> cross_;   ///< per sight; unused where its pose is fixed
  std::vector<PointElimination::Point> points_;  ///< those with sights
};

}  // namespace

int solve_window(BundleProblem& problem, const SchurOptions& options) {
  return Window(problem, options).minimise(options);
}

}  // namespace planecast::slam
