#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "engine/evaluate/trajectory.h"
#include "engine/sequence/groundtruth.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

TimedPose at(double time, const Eigen::Vector3d& position) {
  return {time, make_pose(Eigen::Vector3d::Zero(), position)};
}

std::vector<TimedPose> helix(int count) {
  std::vector<TimedPose> poses;
  for (int i = 0; i < count; ++i) {
    const double a = 0.1 * i;
    poses.push_back(
        {0.1 * i, make_pose({0.0, a, 0.1 * std::sin(a)}, {std::cos(a), 0.05 * i, std::sin(a)})});
  }
  return poses;
}

/// What an estimate of `truth` looks like in a world of its own.
std::vector<TimedPose> seen_from(const slam::Pose& other_from_world, double scale,
                                 std::vector<TimedPose> poses) {
  for (TimedPose& pose : poses) {
    pose.world_from_cam = other_from_world * pose.world_from_cam;
    pose.world_from_cam.translation() *= scale;
  }
  return poses;
}

TEST(Statistics, HandComputed) {
  const Statistics s = statistics_of({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.count, 4);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.p90, 3.7);
  EXPECT_DOUBLE_EQ(s.max, 4.0);
  EXPECT_EQ(statistics_of({}).count, 0);
}

std::vector<TimedPose> timed(const std::vector<double>& times) {
  std::vector<TimedPose> poses;
  for (const double time : times) poses.push_back({time, slam::Pose::Identity()});
  return poses;
}

TEST(Association, NearestFirstOneToOneWithinTheLimit) {
  const std::vector<TimedPose> a = timed({0.0, 0.010, 1.0});
  const std::vector<TimedPose> b = timed({0.008, 0.025, 1.5});
  // (1, 0) differs by 2 ms and comes first; 0 then finds nothing within 20 ms but 25; 2 nothing.
  const std::vector<std::pair<int, int>> expected = {{1, 0}};
  EXPECT_EQ(associate(a, b, 0.02), expected);
  const std::vector<std::pair<int, int>> wider = {{0, 1}, {1, 0}};
  EXPECT_EQ(associate(a, b, 0.03), wider);
}

TEST(TrajectoryError, SimilarityIsUndone) {
  const std::vector<TimedPose> truth = helix(60);
  const auto estimate = seen_from(make_pose({0.3, -1.0, 2.0}, {5.0, 1.0, -2.0}), 0.25, truth);
  const auto result = evaluate_trajectory(estimate, truth);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->pairs, 60);
  EXPECT_NEAR(result->ate.rms, 0.0, 1e-12);
  EXPECT_NEAR(result->truth_from_estimate.scale, 4.0, 1e-12);
  EXPECT_NEAR(result->rpe_translation.rms, 0.0, 1e-12);
  EXPECT_NEAR(result->rpe_rotation_deg.rms, 0.0, 1e-5);  // acos near 1
  EXPECT_EQ(result->rpe_translation.count, 50);          // 60 poses of 0.1 s, 1 s apart
  EXPECT_FALSE(result->nearly_straight);
}

TEST(TrajectoryError, Se3KeepsTheScaleError) {
  const std::vector<TimedPose> truth = helix(60);
  TrajectoryOptions options;
  options.align = Alignment::kSe3;
  const auto result =
      evaluate_trajectory(seen_from(slam::Pose::Identity(), 0.9, truth), truth, options);
  ASSERT_TRUE(result);
  EXPECT_DOUBLE_EQ(result->truth_from_estimate.scale, 1.0);
  // Every position is 10 % nearer to the mean: rms = 0.1 x the spread of the positions.
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const TimedPose& pose : truth) mean += pose.world_from_cam.translation() / 60.0;
  double spread = 0.0;
  for (const TimedPose& pose : truth)
    spread += (pose.world_from_cam.translation() - mean).squaredNorm();
  EXPECT_NEAR(result->ate.rms, 0.1 * std::sqrt(spread / 60.0), 1e-9);
}

TEST(TrajectoryError, HandComputedErrorOfOnePose) {
  // A square whose corners stay but for a push along the normal: +e -e +e -e has no rigid part of
  // first order, so every distance is e.
  const double e = 0.001;
  std::vector<TimedPose> truth = {at(0, {0, 0, 0}), at(1, {1, 0, 0}), at(2, {1, 1, 0}),
                                  at(3, {0, 1, 0})};
  std::vector<TimedPose> estimate = truth;
  for (int i = 0; i < 4; ++i) {
    estimate[static_cast<std::size_t>(i)].world_from_cam.translation().z() = i % 2 == 0 ? e : -e;
  }
  TrajectoryOptions options;
  options.align = Alignment::kSe3;
  const auto result = evaluate_trajectory(estimate, truth, options);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->ate.rms, e, 1e-9);
  EXPECT_NEAR(result->ate.max, e, 1e-9);
  EXPECT_NEAR(result->rpe_translation.rms, 2.0 * e, 1e-9);
  EXPECT_EQ(result->rpe_translation.count, 3);
}

TEST(TrajectoryError, TurnedCameraShowsInRotationAlone) {
  std::vector<TimedPose> truth = helix(30);
  for (TimedPose& pose : truth) pose.world_from_cam.linear().setIdentity();
  std::vector<TimedPose> estimate = truth;
  for (std::size_t i = 0; i < 30; ++i) {  // 2 degrees a second about the viewing axis
    const double angle = 2.0 * M_PI / 180.0 * 0.1 * static_cast<double>(i);
    estimate[i].world_from_cam.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  }
  const auto result = evaluate_trajectory(estimate, truth);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->ate.rms, 0.0, 1e-12);
  EXPECT_NEAR(result->rpe_rotation_deg.median, 2.0, 1e-6);
}

TEST(TrajectoryError, DirectionsHoldWhatAStraightPathLeavesOpen) {
  std::vector<TimedPose> truth;
  for (int i = 0; i < 20; ++i) {
    // A path with as little to the side as an estimate has noise.
    truth.push_back({0.1 * i, make_pose({0.0, 0.0, 0.02 * i}, {0.1 * i, 0.001 * (i % 2), 0.0})});
  }
  const slam::Pose other_from_world = make_pose({0.3, 0.1, -0.2}, {1.0, 2.0, 3.0});
  std::vector<TimedPose> estimate = seen_from(other_from_world, 0.25, truth);
  for (int i = 0; i < 20; ++i) {
    estimate[i].world_from_cam.translation().z() += 0.001 * ((i / 2) % 2);
  }
  const auto result = evaluate_trajectory(estimate, truth);
  ASSERT_TRUE(result);
  const Eigen::Matrix3d error =
      result->truth_from_estimate_by_poses.rotation * other_from_world.linear();
  EXPECT_LT(Eigen::AngleAxisd(error).angle(), 0.01);
  EXPECT_NEAR(result->truth_from_estimate_by_poses.scale, 4.0, 0.01);
}

TEST(TrajectoryError, TooFewPairsAndStraightPaths) {
  const std::vector<TimedPose> line = {at(0, {0, 0, 0}), at(1, {1, 0, 0}), at(2, {2, 0, 0}),
                                       at(3, {3, 0, 0})};
  EXPECT_FALSE(evaluate_trajectory({line[0], line[1]}, line));
  EXPECT_FALSE(evaluate_trajectory({}, line));
  const auto result = evaluate_trajectory(line, line);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->nearly_straight);
  EXPECT_NE(format_table(*result).find("straight"), std::string::npos);
  EXPECT_EQ(to_json(*result).at("pairs"), 4);
}

/// Published trajectories beside the project, where they are present.
fs::path data_folder() {
  const char* set = std::getenv("PLANECAST_DATA");
  return fs::path(set != nullptr ? set : PLANECAST_SOURCE_DIR "/../shared/data") / "trajectories";
}

struct Reference {
  const char* truth;
  const char* estimate;
  int pairs;
  const char* se3;
  const char* sim3;
  const char* scale;
};

/// EXPECTED.txt of that folder: the figures of the TUM benchmark's evaluate_ate.py.
constexpr Reference kReferences[] = {
    {"freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-rgbdslam.txt", 786, "0.013473", "0.013394",
     "1.00792"},
    {"fr2_desk_groundtruth.txt", "fr2_desk_ORB.txt", 2223, "0.008144", "0.006186", "0.99700"},
    {"fr2_desk_groundtruth.txt", "fr2_desk_ORB_kf_mono.txt", 122, "0.948813", "0.007900",
     "2.22834"},
    {"freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-ORB_kf_mono.txt", 32, "0.024302", "0.009755",
     "1.10562"},
};

std::string fixed(double value, int decimals) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

TEST(TrajectoryError, PublishedTrajectoriesToTheLastDigit) {
  if (!fs::exists(data_folder() / kReferences[0].truth)) {
    GTEST_SKIP() << "no published trajectories in " << data_folder();
  }
  for (const Reference& reference : kReferences) {
    const auto truth = read_trajectory(data_folder() / reference.truth);
    const auto estimate = read_trajectory(data_folder() / reference.estimate);
    TrajectoryOptions options;
    const auto sim3 = evaluate_trajectory(estimate, truth, options);
    options.align = Alignment::kSe3;
    const auto se3 = evaluate_trajectory(estimate, truth, options);
    ASSERT_TRUE(sim3 && se3);
    EXPECT_EQ(sim3->pairs, reference.pairs) << reference.estimate;
    EXPECT_EQ(fixed(se3->ate.rms, 6), reference.se3) << reference.estimate;
    EXPECT_EQ(fixed(sim3->ate.rms, 6), reference.sim3) << reference.estimate;
    EXPECT_EQ(fixed(sim3->truth_from_estimate.scale, 5), reference.scale) << reference.estimate;
  }
}

}  // namespace
}  // namespace planecast::engine
