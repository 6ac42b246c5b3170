#include "slam/stages/start_bundle.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "slam/geometry/pose_system.h"
#include "slam/geometry/triangulate.h"
#include "slam/optimize/bundle_problem.h"
#include "slam/optimize/pose.h"
#include "slam/optimize/schur_solver.h"

namespace planecast::slam {
namespace {

/// Frames of the bundle, evenly chosen.
std::vector<std::size_t> chosen_frames(std::size_t count, int most) {
  const std::size_t chosen = std::min(count, static_cast<std::size_t>(most));
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < chosen; ++i) frames.push_back(i * (count - 1) / (chosen - 1));
  return frames;
}

/// The share of a motion, turned and moved alike.
Pose share_of(const Pose& motion, double share) {
  const Eigen::AngleAxisd turn(motion.linear());
  Pose part = Pose::Identity();
  part.linear() = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
  part.translation() = share * motion.translation();
  return part;
}

class Builder {
 public:
  Builder(const Camera& camera, const FollowedCorners& corners, const StartBundleOptions& options)
      : camera_(camera),
        corners_(corners),
        frames_(chosen_frames(corners.pixels.size(), options.max_frames)) {}

  /// Points from the reference and the newest frame, poses of those between from the points. False
  /// with fewer than `least` points in front of both.
  bool build(const Pose& newest_from_ref, double least) {
    const std::vector<Eigen::Vector2d>& first = corners_.pixels.front();
    const std::vector<Eigen::Vector2d>& last = corners_.pixels.back();
    for (std::size_t c = 0; c < first.size(); ++c) {
      const auto point = triangulate(camera_, Pose::Identity(), first[c], newest_from_ref, last[c]);
      if (!point) continue;
      corner_of_.push_back(c);
      problem_.points.push_back(*point);
    }
    if (static_cast<double>(problem_.points.size()) < std::max(3.0, least)) return false;
    const auto span = static_cast<double>(corners_.pixels.size() - 1);
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      const Pose guess = share_of(newest_from_ref, static_cast<double>(frames_[f]) / span);
      const bool ends = f == 0 || f + 1 == frames_.size();
      problem_.poses.push_back(block_from_pose(ends ? guess : seen_from(f, guess)));
      problem_.fixed.push_back(f == 0 ? 1 : 0);
      problem_.keyframes.push_back(static_cast<KeyframeId>(f));
    }
    const PoseOptions thresholds;
    problem_.chi2_mono = thresholds.chi2_mono;
    problem_.chi2_depth = thresholds.chi2_depth;
    for (std::size_t i = 0; i < problem_.points.size(); ++i) {
      problem_.landmarks.push_back(static_cast<LandmarkId>(i));
      for (std::size_t f = 0; f < frames_.size(); ++f) {
        problem_.observations.push_back(
            {static_cast<int>(f), static_cast<int>(i),
             ReprojectionTerm(camera_, thresholds.depth_baseline_m, pixel(f, i),
                              corners_.sigma_px[corner_of_[i]], 0.0),
             true});
      }
    }
    return true;
  }

  BundleProblem& problem() { return problem_; }
  std::size_t corner_of(std::size_t point) const { return corner_of_[point]; }

 private:
  const Eigen::Vector2d& pixel(std::size_t frame, std::size_t point) const {
    return corners_.pixels[frames_[frame]][corner_of_[point]];
  }

  Pose seen_from(std::size_t frame, const Pose& guess) const {
    std::vector<PoseObservation> observations;
    for (std::size_t i = 0; i < problem_.points.size(); ++i) {
      PoseObservation seen;
      seen.point_world = problem_.points[i];
      seen.pixel = pixel(frame, i);
      seen.sigma_px = corners_.sigma_px[corner_of_[i]];
      observations.push_back(seen);
    }
    return optimize_pose(camera_, guess, observations).cam_from_world;
  }

  const Camera& camera_;
  const FollowedCorners& corners_;
  std::vector<std::size_t> frames_;
  std::vector<std::size_t> corner_of_;  ///< per point
  BundleProblem problem_;
};

/// Normal equations of the solved bundle, for the uncertainty of its depths.
class DepthUncertainty {
 public:
  explicit DepthUncertainty(const BundleProblem& problem) : problem_(problem) {
    const auto size = static_cast<Eigen::Index>(6 * (problem.poses.size() - 1));
    Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t begin = 0; begin < problem.observations.size();) {
      const std::size_t end = end_of_point(begin);
      const Point point = linearise(begin, end, &reduced);
      reduced -= point.cross * point.hessian.inverse() * point.cross.transpose();
      begin = end;
    }
    // The scale is open: its direction has the least eigenvalue and is left out.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(reduced);
    Eigen::VectorXd inverse = solver.eigenvalues();
    const double least = 1e-12 * inverse[inverse.size() - 1];
    for (Eigen::Index i = 0; i < inverse.size(); ++i) {
      inverse[i] = i == 0 ? 0.0 : 1.0 / std::max(inverse[i], least);
    }
    pose_covariance_ =
        solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  }

  /// Median over every so many points of the relative standard deviation, for residuals of
  /// variance 1.
  double median_relative(int points) const {
    std::vector<double> relative;
    const std::size_t every =
        std::max<std::size_t>(1, problem_.points.size() / static_cast<std::size_t>(points));
    for (std::size_t begin = 0; begin < problem_.observations.size();) {
      const std::size_t end = end_of_point(begin);
      const auto index = static_cast<std::size_t>(problem_.observations[begin].point);
      if (index % every == 0 && problem_.observations[begin].active) {
        const Point point = linearise(begin, end, nullptr);
        const Eigen::Matrix3d inverse = point.hessian.inverse();
        const Eigen::Matrix3d covariance =
            inverse +
            inverse * (point.cross.transpose() * pose_covariance_ * point.cross) * inverse;
        relative.push_back(std::sqrt(std::max(0.0, covariance(2, 2))) / problem_.points[index].z());
      }
      begin = end;
    }
    if (relative.empty()) return std::numeric_limits<double>::infinity();
    const auto middle = relative.begin() + static_cast<std::ptrdiff_t>(relative.size() / 2);
    std::nth_element(relative.begin(), middle, relative.end());
    return *middle;
  }

 private:
  struct Point {
    Eigen::Matrix3d hessian = 1e-12 * Eigen::Matrix3d::Identity();
    Eigen::MatrixXd cross;  ///< rows of the poses, columns of the point
  };

  std::size_t end_of_point(std::size_t begin) const {
    const std::vector<BundleObservation>& all = problem_.observations;
    std::size_t end = begin + 1;
    while (end < all.size() && all[end].point == all[begin].point) ++end;
    return end;
  }

  /// The blocks of one point; those of the poses are added to `poses` where it is given.
  Point linearise(std::size_t begin, std::size_t end, Eigen::MatrixXd* poses) const {
    Point point;
    point.cross =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * (problem_.poses.size() - 1)), 3);
    for (std::size_t i = begin; i < end; ++i) {
      const BundleObservation& seen = problem_.observations[i];
      if (!seen.active) continue;
      double residuals[2];
      Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_pose;
      Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
      seen.term.evaluate(problem_.poses[static_cast<std::size_t>(seen.pose)].data(),
                         problem_.points[static_cast<std::size_t>(seen.point)].data(), 1.0,
                         residuals, by_pose.data(), by_point.data(), nullptr);
      point.hessian += by_point.transpose() * by_point;
      if (seen.pose == 0) continue;
      const auto row = static_cast<Eigen::Index>(6 * (seen.pose - 1));
      const Eigen::Matrix<double, 2, 6> by_step = by_pose.leftCols<6>();
      point.cross.block<6, 3>(row, 0) = by_step.transpose() * by_point;
      if (poses != nullptr) poses->block<6, 6>(row, row) += by_step.transpose() * by_step;
    }
    return point;
  }

  const BundleProblem& problem_;
  Eigen::MatrixXd pose_covariance_;
};

/// Points that every frame agrees on.
std::vector<char> agreed(const BundleProblem& problem) {
  std::vector<char> result(problem.points.size(), 1);
  for (const BundleObservation& seen : problem.observations) {
    if (!seen.active) result[static_cast<std::size_t>(seen.point)] = 0;
  }
  return result;
}

/// Of the normalised residuals of all active observations, for the freedom that the unknowns leave.
double residual_variance(const BundleProblem& problem) {
  double sum = 0.0;
  int rows = 0;
  for (const BundleObservation& seen : problem.observations) {
    if (!seen.active) continue;
    sum += problem.chi2(seen);
    rows += 2;
  }
  const auto unknowns = 3 * problem.points.size() + 6 * (problem.poses.size() - 1);
  return sum / std::max(1.0, static_cast<double>(rows) - static_cast<double>(unknowns));
}

/// Every so many corners.
FollowedCorners some_of(const FollowedCorners& all, int most) {
  const std::size_t count = all.sigma_px.size();
  const std::size_t every = std::max<std::size_t>(1, count / static_cast<std::size_t>(most));
  FollowedCorners some;
  some.pixels.resize(all.pixels.size());
  for (std::size_t c = 0; c < count; c += every) {
    some.sigma_px.push_back(all.sigma_px[c]);
    for (std::size_t f = 0; f < all.pixels.size(); ++f) {
      some.pixels[f].push_back(all.pixels[f][c]);
    }
  }
  return some;
}

/// Whether two relative poses of unknown scale are one.
bool is_same(const Pose& a, const Pose& b) {
  constexpr double kSameTurn = 0.003;  // radians
  constexpr double kSameWay = 0.98;    // cosine
  const Eigen::AngleAxisd turn(a.linear() * b.linear().transpose());
  return turn.angle() < kSameTurn &&
         a.translation().normalized().dot(b.translation().normalized()) > kSameWay;
}

}  // namespace

std::optional<StartBundle> bundle_best_start(const Camera& camera, const FollowedCorners& corners,
                                             const std::vector<Pose>& newest_from_ref,
                                             const StartBundleOptions& options) {
  const FollowedCorners some = some_of(corners, options.trial_corners);
  std::vector<StartBundle> trials;
  std::size_t best = 0;
  for (const Pose& candidate : newest_from_ref) {
    std::optional<StartBundle> trial = bundle_start(camera, some, candidate, options);
    if (!trial) continue;
    trials.push_back(*std::move(trial));
    if (trials.back().variance < trials[best].variance) best = trials.size() - 1;
  }
  if (trials.empty()) return std::nullopt;
  for (const StartBundle& trial : trials) {
    if (!is_same(trial.newest_from_ref, trials[best].newest_from_ref) &&
        trial.variance < options.min_variance_ratio * trials[best].variance) {
      return std::nullopt;
    }
  }
  std::optional<StartBundle> result =
      bundle_start(camera, corners, trials[best].newest_from_ref, options);
  if (result && !result->good) result.reset();
  return result;
}

std::optional<StartBundle> bundle_start(const Camera& camera, const FollowedCorners& corners,
                                        const Pose& newest_from_ref,
                                        const StartBundleOptions& options) {
  if (static_cast<int>(corners.pixels.size()) < std::max(2, options.min_frames)) {
    return std::nullopt;
  }
  Builder builder(camera, corners, options);
  const auto least = std::max(static_cast<double>(options.min_points),
                              options.min_share * static_cast<double>(corners.sigma_px.size()));
  if (!builder.build(newest_from_ref, least)) return std::nullopt;
  BundleProblem& problem = builder.problem();
  constexpr int kIterations = 10;
  deactivate_outliers(problem, std::numeric_limits<double>::infinity());
  solve_window(problem, {kIterations, RobustLoss::kHuber, 1e-4});
  deactivate_outliers(problem);
  solve_window(problem, {kIterations, RobustLoss::kSquared, 1e-5});
  deactivate_outliers(problem);

  StartBundle result;
  result.newest_from_ref = pose_from_block(problem.poses.back());
  result.points_ref.resize(corners.sigma_px.size());
  const std::vector<char> good = agreed(problem);
  int count = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    if (good[i] == 0 || !(problem.points[i].z() > 0.0)) continue;
    result.points_ref[builder.corner_of(i)] = problem.points[i];
    ++count;
  }
  if (count < least) return std::nullopt;
  result.variance = residual_variance(problem);
  // Residuals that happen to be small do not make the depths better than the corners are.
  constexpr double kLeastVariance = 0.03;
  result.depth_error = DepthUncertainty(problem).median_relative(options.checked_points) *
                       std::sqrt(std::max(result.variance, kLeastVariance));
  result.good =
      result.variance <= options.max_variance && result.depth_error <= options.max_depth_error;
  return result;
}

}  // namespace planecast::slam
