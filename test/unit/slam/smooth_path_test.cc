#include "slam/stages/smooth_path.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "slam/geometry/pose_system.h"
#include "slam/geometry/random.h"
#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

constexpr int kFrames = 200;
constexpr double kFrameRate = 30.0;

/// A hand that sways at 0.6 and 0.4 Hz.
Pose swaying(int frame) {
  const double t = frame / kFrameRate;
  PoseStep step;
  step << 0.05 * std::sin(3.8 * t), 0.1 * std::sin(2.5 * t), 0.03 * std::cos(3.8 * t),
      0.2 * std::sin(2.5 * t), 0.05 * std::cos(3.8 * t), 0.1 * std::sin(2.5 * t + 1.0);
  return stepped(Pose::Identity(), step);
}

/// Standard deviations of a pose that is seen at 0.2 px in a room.
PoseStep sigmas() {
  PoseStep sigma;
  sigma << 3e-4, 3e-4, 2e-4, 8e-4, 8e-4, 1e-3;
  return sigma;
}

Eigen::Matrix<double, 6, 6> information() {
  return sigmas().cwiseAbs2().cwiseInverse().asDiagonal();
}

PoseStep noise(Random& random) {
  PoseStep step;
  for (int i = 0; i < 6; ++i) step[i] = sigmas()[i] * synthetic::gaussian(random);
  return step;
}

PoseStep difference(const Pose& a, const Pose& b) {
  const Pose change = b * a.inverse();
  const Eigen::AngleAxisd turn(change.linear());
  PoseStep result;
  result << turn.angle() * turn.axis(), change.translation();
  return result;
}

/// Root mean square distance to the truth, in standard deviations of one frame, and that of the
/// second differences of these distances.
struct Errors {
  double rms = 0.0;
  double jitter = 0.0;
};

Errors errors_of(const std::vector<Pose>& path, const std::vector<Pose>& truth) {
  std::vector<PoseStep> away;
  for (std::size_t i = 0; i < path.size(); ++i) {
    away.push_back(difference(truth[i], path[i]).cwiseQuotient(sigmas()));
  }
  Errors errors;
  for (std::size_t i = 1; i + 1 < away.size(); ++i) {
    errors.rms += away[i].squaredNorm() / 6.0;
    errors.jitter += (away[i + 1] - 2.0 * away[i] + away[i - 1]).squaredNorm() / 6.0;
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(away.size()));
  errors.jitter = std::sqrt(errors.jitter / static_cast<double>(away.size()));
  return errors;
}

TEST(SmoothPath, TakesNoiseAwayFromASwayingHand) {
  Random random(synthetic::seed_of("SmoothPath.TakesNoiseAwayFromASwayingHand"));
  std::vector<Pose> truth, measured;
  std::vector<PathPose> path;
  for (int i = 0; i < kFrames; ++i) {
    truth.push_back(swaying(i));
    measured.push_back(stepped(truth.back(), noise(random)));
    path.push_back({measured.back(), information()});
  }
  const Errors before = errors_of(measured, truth);
  const Errors after = errors_of(smooth_path(path), truth);
  EXPECT_NEAR(before.rms, 1.0, 0.1);
  // A third of the error and seven tenths of the trembling go; the rest looks like motion.
  EXPECT_LT(after.rms, 0.667 * before.rms);
  EXPECT_LT(after.jitter, 0.3 * before.jitter);
}

TEST(SmoothPath, LeavesRealShakingAlone) {
  Random random(synthetic::seed_of("SmoothPath.LeavesRealShakingAlone"));
  std::vector<Pose> truth;
  std::vector<PathPose> path;
  for (int i = 0; i < kFrames; ++i) {
    // Ten times what the poses' own uncertainty explains.
    truth.push_back(stepped(swaying(i), 10.0 * noise(random)));
    path.push_back({stepped(truth.back(), noise(random)), information()});
  }
  EXPECT_LT(errors_of(smooth_path(path), truth).rms, 1.1);
}

TEST(SmoothPath, MovesNoFrameBeyondItsUncertainty) {
  Random random(synthetic::seed_of("SmoothPath.MovesNoFrameBeyondItsUncertainty"));
  std::vector<PathPose> path;
  for (int i = 0; i < kFrames; ++i) {
    path.push_back({stepped(swaying(i), noise(random)), information()});
  }
  // One frame is far off and sure of itself.
  PoseStep jump = PoseStep::Zero();
  jump[3] = 0.05;
  path[90].cam_from_world = stepped(path[90].cam_from_world, jump);
  const SmoothPathOptions options;
  const std::vector<Pose> smooth = smooth_path(path, options);
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    const PoseStep away = difference(path[i].cam_from_world, smooth[i]);
    EXPECT_LE(away.dot(path[i].information * away), 1.001 * options.max_chi2) << i;
  }
}

TEST(SmoothPath, AShortPathStaysAsItIs) {
  std::vector<PathPose> path;
  for (int i = 0; i < 5; ++i) path.push_back({swaying(7 * i), information()});
  const std::vector<Pose> smooth = smooth_path(path);
  ASSERT_EQ(smooth.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_TRUE(smooth[i].isApprox(path[i].cam_from_world, 0.0));
  }
  EXPECT_TRUE(smooth_path({}).empty());
}

}  // namespace
}  // namespace planecast::slam
