#include "slam/stages/smooth_path.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "slam/geometry/pose_system.h"

namespace planecast::slam {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Weights of four poses in a third difference, squared and summed: what it makes of white noise.
constexpr double kNoiseOfDifference = 20.0;
/// From the median of squares of a normal distribution to its variance.
constexpr double kVarianceFromMedian = 1.0 / 0.4549;
constexpr int kGaussNewton = 3;
/// A frame that went too far is held so many times tighter.
constexpr double kTighten = 3.0;

/// Rotation vector and translation of a small motion.
Vector6 motion(const Pose& from, const Pose& to) {
  const Pose change = to * from.inverse(Eigen::Isometry);
  const Eigen::AngleAxisd turn(change.linear());
  Vector6 result;
  result << turn.angle() * turn.axis(), change.translation();
  return result;
}

/// How a step of `from` changes the motion to `to`, but for the sign: the adjoint.
Matrix6 adjoint(const Pose& from, const Pose& to) {
  const Pose change = to * from.inverse(Eigen::Isometry);
  const Eigen::Vector3d& t = change.translation();
  Eigen::Matrix3d hat;
  hat << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() = change.linear();
  result.bottomRightCorner<3, 3>() = change.linear();
  result.bottomLeftCorner<3, 3>() = hat * change.linear();
  return result;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Smoother {
 public:
  Smoother(const std::vector<PathPose>& path, const SmoothPathOptions& options)
      : path_(path), options_(options), hold_(path.size(), 1.0) {
    for (const PathPose& frame : path) poses_.push_back(frame.cam_from_world);
    weigh_motion();
  }

  std::vector<Pose> solve() {
    for (int round = 0; round < options_.rounds; ++round) {
      for (int i = 0; i < kGaussNewton; ++i) {
        if (!step()) return measured();
      }
      if (!tighten()) return poses_;
    }
    // What is still too far is left where it was.
    for (std::size_t i = 0; i < path_.size(); ++i) {
      if (chi2(i) > options_.max_chi2) poses_[i] = path_[i].cam_from_world;
    }
    return poses_;
  }

 private:
  std::size_t differences() const { return path_.size() - 3; }

  std::vector<Pose> measured() const {
    std::vector<Pose> poses;
    for (const PathPose& frame : path_) poses.push_back(frame.cam_from_world);
    return poses;
  }

  Vector6 difference(std::size_t i) const {
    return motion(poses_[i + 2], poses_[i + 3]) - 2.0 * motion(poses_[i + 1], poses_[i + 2]) +
           motion(poses_[i], poses_[i + 1]);
  }

  /// Inverse variances of the third differences, from those of the path as it was localised.
  void weigh_motion() {
    std::vector<Vector6> squares;
    std::vector<Vector6> noise;
    for (std::size_t i = 0; i < differences(); ++i) {
      squares.push_back(difference(i).cwiseAbs2());
      noise.push_back(kNoiseOfDifference * path_[i + 1].information.inverse().diagonal());
    }
    weight_.resize(differences());
    std::vector<double> near;
    const auto median_about = [&](const std::vector<Vector6>& values, std::size_t i, int row) {
      const auto reach = static_cast<std::size_t>(options_.window);
      near.clear();
      for (std::size_t j = i > reach ? i - reach : 0; j < std::min(values.size(), i + reach + 1);
           ++j) {
        near.push_back(values[j][row]);
      }
      return median(near);
    };
    for (std::size_t i = 0; i < differences(); ++i) {
      for (int row = 0; row < 6; ++row) {
        const double unrest = kVarianceFromMedian * median_about(squares, i, row);
        const double moving =
            std::max(unrest - median_about(noise, i, row), options_.min_motion_share * unrest);
        weight_[i][row] = 1.0 / std::max(moving, 1e-18);
      }
    }
  }

  /// The deviation from what was localised.
  Vector6 deviation(std::size_t i) const { return motion(path_[i].cam_from_world, poses_[i]); }

  double chi2(std::size_t i) const {
    const Vector6 away = deviation(i);
    return away.dot(path_[i].information * away);
  }

  /// Holds frames tighter that went too far; false where none did.
  bool tighten() {
    bool any = false;
    for (std::size_t i = 0; i < path_.size(); ++i) {
      if (chi2(i) <= options_.max_chi2) continue;
      hold_[i] *= kTighten;
      any = true;
    }
    return any;
  }

  bool step() {
    const auto size = static_cast<Eigen::Index>(6 * path_.size());
    entries_.clear();
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const Matrix6 information = hold_[i] * path_[i].information;
      add_block(i, i, information);
      gradient.segment<6>(static_cast<Eigen::Index>(6 * i)) += information * deviation(i);
    }
    for (std::size_t i = 0; i < differences(); ++i) add_difference(i, gradient);
    Eigen::SparseMatrix<double> system(size, size);
    system.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::VectorXd solution = -solver.solve(gradient);
    if (!solution.allFinite()) return false;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      poses_[i] = stepped(poses_[i], solution.segment<6>(static_cast<Eigen::Index>(6 * i)));
    }
    return true;
  }

  /// A motion changes by (step of the later pose) - adjoint * (step of the earlier one).
  void add_difference(std::size_t i, Eigen::VectorXd& gradient) {
    std::array<Matrix6, 4> by_pose;
    by_pose.fill(Matrix6::Zero());
    constexpr std::array<double, 3> kWeights = {1.0, -2.0, 1.0};
    for (std::size_t m = 0; m < 3; ++m) {
      by_pose[m + 1] += kWeights[m] * Matrix6::Identity();
      by_pose[m] -= kWeights[m] * adjoint(poses_[i + m], poses_[i + m + 1]);
    }
    const Vector6 residual = difference(i);
    for (std::size_t a = 0; a < 4; ++a) {
      const Matrix6 weighted = by_pose[a].transpose() * weight_[i].asDiagonal();
      gradient.segment<6>(static_cast<Eigen::Index>(6 * (i + a))) += weighted * residual;
      for (std::size_t b = 0; b < 4; ++b) add_block(i + a, i + b, weighted * by_pose[b]);
    }
  }

  void add_block(std::size_t row, std::size_t column, const Matrix6& block) {
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) {
        entries_.emplace_back(static_cast<int>(6 * row) + r, static_cast<int>(6 * column) + c,
                              block(r, c));
      }
    }
  }

  const std::vector<PathPose>& path_;
  const SmoothPathOptions& options_;
  std::vector<Pose> poses_;
  std::vector<double> hold_;     ///< factor on each frame's information
  std::vector<Vector6> weight_;  ///< per third difference
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

std::vector<Pose> smooth_path(const std::vector<PathPose>& path, const SmoothPathOptions& options) {
  if (static_cast<int>(path.size()) < std::max(4, options.min_frames)) {
    std::vector<Pose> poses;
    for (const PathPose& frame : path) poses.push_back(frame.cam_from_world);
    return poses;
  }
  return Smoother(path, options).solve();
}

}  // namespace planecast::slam
