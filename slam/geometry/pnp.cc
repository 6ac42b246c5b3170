#include "slam/geometry/pnp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <utility>

#include "slam/geometry/pose_system.h"
#include "slam/geometry/random.h"

namespace planecast::slam {
namespace {

constexpr int kSampleSize = 3;
/// With which an all-inlier sample has been drawn when the search ends early.
constexpr double kConfidence = 0.999;
constexpr int kRefinementSteps = 10;
constexpr int kRefinementRounds = 4;
/// A refinement ends at steps (radians, map units) below this.
constexpr double kStepTolerance = 1e-10;

class PnpProblem {
 public:
  PnpProblem(const Camera& camera, const std::vector<Eigen::Vector3d>& points_world,
             const std::vector<Eigen::Vector2d>& pixels, const std::vector<double>& sigma_px,
             double threshold_px)
      : camera_(camera),
        points_(points_world),
        pixels_(pixels),
        sigma_(sigma_px),
        gate_(threshold_px * threshold_px) {}

  int size() const { return static_cast<int>(points_.size()); }

  /// MSAC: sum of squared errors over sigma, each cut off at the gate. Stops once it exceeds
  /// `limit`.
  double cost(const Pose& pose, double limit) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < points_.size() && sum < limit; ++i)
      sum += std::min(error(pose, i), gate_);
    return sum;
  }

  int mark_inliers(const Pose& pose, std::vector<char>& inlier) const {
    inlier.resize(points_.size());
    int count = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      inlier[i] = error(pose, i) < gate_;
      count += inlier[i];
    }
    return count;
  }

  /// Gauss-Newton over the marked points; precondition: they are in front of the camera.
  Pose refine(const Pose& initial, const std::vector<char>& inlier) const {
    Pose pose = initial;
    for (int iteration = 0; iteration < kRefinementSteps; ++iteration) {
      const PoseStep step = linearise(pose, inlier).solve(0.0);
      if (!step.allFinite()) return initial;
      pose = stepped(pose, step);
      if (step.norm() < kStepTolerance) break;
    }
    return pose;
  }

  /// Poses (up to four) from three pairs.
  std::vector<Pose> solve_minimal(const std::array<int, kSampleSize>& sample) const {
    cv::Matx<double, kSampleSize, 3> object;
    cv::Matx<double, kSampleSize, 2> image;
    for (int row = 0; row < kSampleSize; ++row) {
      const auto index = static_cast<std::size_t>(sample[static_cast<std::size_t>(row)]);
      const Eigen::Vector3d ray = camera_.ray(pixels_[index]);
      for (int k = 0; k < 3; ++k) object(row, k) = points_[index](k);
      for (int k = 0; k < 2; ++k) image(row, k) = ray(k);
    }
    std::vector<cv::Vec3d> turns, translations;
    cv::solveP3P(object, image, cv::Matx33d::eye(), cv::noArray(), turns, translations,
                 cv::SOLVEPNP_AP3P);
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      Pose pose = Pose::Identity();
      pose.linear() = rotation_exp({turns[i][0], turns[i][1], turns[i][2]}).toRotationMatrix();
      pose.translation() =
          Eigen::Vector3d(translations[i][0], translations[i][1], translations[i][2]);
      if (pose.matrix().allFinite()) poses.push_back(pose);
    }
    return poses;
  }

 private:
  /// Squared reprojection error over sigma squared; at the gate for a point that is not in front.
  double error(const Pose& pose, std::size_t i) const {
    const Eigen::Vector3d point = pose * points_[i];
    if (!(point.z() > 0.0)) return gate_;
    return (camera_.project(point) - pixels_[i]).squaredNorm() / (sigma_[i] * sigma_[i]);
  }

  PoseSystem linearise(const Pose& pose, const std::vector<char>& inlier) const {
    PoseSystem system;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d p = pose * points_[i];
      if (!inlier[i] || !(p.z() > 0.0)) continue;
      const Eigen::Vector2d residual = camera_.project(p) - pixels_[i];
      const double weight = 1.0 / (sigma_[i] * sigma_[i]);
      const double fx = camera_.fx / p.z();
      const double fy = camera_.fy / p.z();
      system.add(p, {fx, 0.0, -fx * p.x() / p.z()}, residual.x(), weight);
      system.add(p, {0.0, fy, -fy * p.y() / p.z()}, residual.y(), weight);
    }
    return system;
  }

  const Camera& camera_;
  const std::vector<Eigen::Vector3d>& points_;
  const std::vector<Eigen::Vector2d>& pixels_;
  const std::vector<double>& sigma_;
  double gate_;
};

int needed_iterations(int inliers, int size, int most) {
  const double share = static_cast<double>(inliers) / size;
  const double all_inliers = share * share * share;
  if (all_inliers >= 1.0) return 1;
  if (all_inliers <= 0.0) return most;
  const double needed = std::log(1.0 - kConfidence) / std::log1p(-all_inliers);
  return needed < most ? static_cast<int>(std::ceil(needed)) : most;
}

}  // namespace

std::optional<PnpResult> solve_pnp(const Camera& camera,
                                   const std::vector<Eigen::Vector3d>& points_world,
                                   const std::vector<Eigen::Vector2d>& pixels,
                                   const std::vector<double>& sigma_px, const PnpOptions& options) {
  const PnpProblem problem(camera, points_world, pixels, sigma_px, options.threshold_px);
  const int min_inliers = std::max(options.min_inliers, kSampleSize + 1);
  if (problem.size() < min_inliers) return std::nullopt;
  Random random(options.seed);
  PnpResult best;
  // That of a pose without inliers.
  double best_cost = problem.size() * options.threshold_px * options.threshold_px;
  const auto keep_if_better = [&](const Pose& pose) {
    const double cost = problem.cost(pose, best_cost);
    if (!(cost < best_cost)) return false;
    best_cost = cost;
    best.cam_from_world = pose;
    best.num_inliers = problem.mark_inliers(pose, best.inlier);
    return true;
  };
  int iterations = options.iterations;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    std::array<int, kSampleSize> sample;
    random.distinct(kSampleSize, problem.size(), sample.data());
    for (const Pose& pose : problem.solve_minimal(sample)) {
      if (!keep_if_better(pose) || best.num_inliers <= kSampleSize) continue;
      keep_if_better(problem.refine(best.cam_from_world, best.inlier));
      iterations = needed_iterations(best.num_inliers, problem.size(), options.iterations);
    }
  }
  if (best.num_inliers < min_inliers) return std::nullopt;
  for (int round = 0; round < kRefinementRounds; ++round) {
    if (!keep_if_better(problem.refine(best.cam_from_world, best.inlier))) break;
  }
  return best.num_inliers >= min_inliers ? std::optional(std::move(best)) : std::nullopt;
}

}  // namespace planecast::slam
