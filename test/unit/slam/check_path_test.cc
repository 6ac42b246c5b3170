#include "slam/stages/check_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

constexpr std::size_t kFrames = 120;

/// A hand that sways, with a tremble of half a millimetre and half a milliradian.
std::vector<Pose> swaying_path(const char* name) {
  Random random(seed_of(name));
  std::vector<Pose> path;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double t = static_cast<double>(i) / 30.0;
    path.push_back(pose_at(
        Eigen::Vector3d(0.4 * t, 0.05 * std::sin(3.0 * t), 0.0) + 5e-4 * gaussian3(random),
        Eigen::Vector3d(0.02 * std::sin(2.0 * t), 0.3 * t, 0.0) + 5e-4 * gaussian3(random)));
  }
  return path;
}

std::vector<std::size_t> doubted(const std::vector<char>& trusted) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < trusted.size(); ++i) {
    if (trusted[i] == 0) result.push_back(i);
  }
  return result;
}

double distance(const Pose& a, const Pose& b) {
  return (a.inverse().translation() - b.inverse().translation()).norm();
}

TEST(CheckPath, TrustsAHandThatSways) {
  const std::vector<Pose> path = swaying_path("CheckPath.TrustsAHandThatSways");
  EXPECT_TRUE(doubted(check_path(path, std::vector<int>(kFrames, 150))).empty());
}

TEST(CheckPath, DoubtsAFrameThatJumpsAwayAndBack) {
  const std::vector<Pose> truth = swaying_path("CheckPath.DoubtsAFrameThatJumpsAwayAndBack");
  std::vector<Pose> path = truth;
  path[50] = pose_at({0.1, 0.0, 0.05}, {0.0, 0.02, 0.0}) * path[50];
  const std::vector<char> trusted = check_path(path, std::vector<int>(kFrames, 150));
  EXPECT_EQ(doubted(trusted), std::vector<std::size_t>({50}));
  EXPECT_LT(distance(pose_between(path, trusted, 50), truth[50]), 0.004);
}

TEST(CheckPath, DoubtsTheWeakerOfNeighboursThatContradictEachOther) {
  const std::vector<Pose> truth =
      swaying_path("CheckPath.DoubtsTheWeakerOfNeighboursThatContradictEachOther");
  std::vector<Pose> path = truth;
  std::vector<int> support(kFrames, 150);
  for (const std::size_t i : {70U, 71U}) {
    path[i] = pose_at({0.1, 0.0, 0.05}, {0.0, 0.02, 0.0}) * path[i];
    support[i] = 60;
  }
  const std::vector<char> trusted = check_path(path, support);
  EXPECT_EQ(trusted[70], 0);
  EXPECT_EQ(trusted[71], 0);
  EXPECT_LT(distance(pose_between(path, trusted, 70), truth[70]), 0.01);
  EXPECT_LT(distance(pose_between(path, trusted, 71), truth[71]), 0.01);
}

TEST(CheckPath, FollowsARealTurnOfTheHand) {
  std::vector<Pose> path = swaying_path("CheckPath.FollowsARealTurnOfTheHand");
  // From here on the camera goes another way, as fast.
  for (std::size_t i = 60; i < kFrames; ++i) {
    const double t = static_cast<double>(i - 60) / 30.0;
    path[i] = pose_at({-0.6 * t, 0.0, 0.2 * t}, {0.0, 0.0, 0.0}) * path[i];
  }
  EXPECT_LE(doubted(check_path(path, std::vector<int>(kFrames, 150))).size(), 2U);
}

TEST(CheckPath, LeavesShortPathsAlone) {
  std::vector<Pose> path = swaying_path("CheckPath.LeavesShortPathsAlone");
  path.resize(8);
  path[4] = pose_at({1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}) * path[4];
  EXPECT_TRUE(doubted(check_path(path, std::vector<int>(8, 150))).empty());
  EXPECT_TRUE(check_path({}, {}).empty());
}

}  // namespace
}  // namespace planecast::slam
