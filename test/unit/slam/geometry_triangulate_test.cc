#include "slam/geometry/triangulate.h"

#include <gtest/gtest.h>

#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

struct Views {
  Camera camera = synthetic::camera();
  Pose a = pose_at({-0.2, 0.1, 0.3}, {0.1, 0.0, -0.05});
  Pose b = pose_at({0.3, 0.0, 0.2}, {0.05, -0.1, 0.0});
};

TEST(Triangulate, ExactPixelsGiveTheExactPoint) {
  Random random(seed_of("Triangulate.ExactPixelsGiveTheExactPoint"));
  Views views;
  for (const double fy : {520.0, -480.0}) {
    views.camera.fy = fy;
    for (const Eigen::Vector3d& point : box_points(200, random)) {
      const auto found = triangulate(views.camera, views.a, views.camera.project(views.a * point),
                                     views.b, views.camera.project(views.b * point));
      ASSERT_TRUE(found);
      EXPECT_LT((*found - point).norm(), 1e-9);
    }
  }
}

TEST(Triangulate, NoiseStaysInTheReprojection) {
  Random random(seed_of("Triangulate.NoiseStaysInTheReprojection"));
  const Views views;
  const double sigma_px = 1.0;
  double squared = 0.0;
  int count = 0;
  for (const Eigen::Vector3d& point : box_points(2000, random)) {
    const Eigen::Vector2d in_a = noisy(views.camera.project(views.a * point), sigma_px, random);
    const Eigen::Vector2d in_b = noisy(views.camera.project(views.b * point), sigma_px, random);
    const auto found = triangulate(views.camera, views.a, in_a, views.b, in_b);
    ASSERT_TRUE(found);
    squared += (views.camera.project(views.a * *found) - in_a).squaredNorm() +
               (views.camera.project(views.b * *found) - in_b).squaredNorm();
    ++count;
  }
  // Four measurements, three unknowns: the optimum leaves one degree of freedom, chi2 = sigma^2 (1
  // +- 3 sqrt(2/n)); a linear solution leaves more.
  EXPECT_NEAR(squared / count, 1.0, 3.0 * std::sqrt(2.0 / count));
}

TEST(Triangulate, RefusesPointsBehindAndAtInfinity) {
  const Views views;
  const Eigen::Vector3d behind(0.1, 0.2, -4.0);
  EXPECT_FALSE(triangulate(views.camera, views.a, views.camera.project(views.a * behind), views.b,
                           views.camera.project(views.b * behind)));
  const Pose shifted = Eigen::Translation3d(-0.5, 0.0, 0.0) * Pose::Identity();
  EXPECT_FALSE(
      triangulate(views.camera, Pose::Identity(), {300.0, 200.0}, shifted, {300.0, 200.0}));
  EXPECT_FALSE(triangulate(views.camera, views.a, {300.0, 200.0}, views.a, {310.0, 200.0}));
}

TEST(Parallax, IsTheAngleBetweenTheRays) {
  const Pose a = pose_at({-1.0, 0.0, 0.0}, {0.1, 0.2, 0.3});
  const Pose b = pose_at({1.0, 0.0, 0.0}, {-0.2, 0.0, 0.1});
  EXPECT_NEAR(parallax_cosine(a, b, {0.0, 0.0, 1.0}), 0.0, 1e-12);
  EXPECT_NEAR(parallax_cosine(a, b, {0.0, 0.0, std::sqrt(3.0)}), 0.5, 1e-12);
}

TEST(FundamentalFromPoses, HoldsForProjections) {
  Random random(seed_of("FundamentalFromPoses.HoldsForProjections"));
  const Views views;
  const Eigen::Matrix3d f = fundamental_from_poses(views.camera, views.a, views.b);
  for (const Eigen::Vector3d& point : box_points(50, random)) {
    const Eigen::Vector3d in_a = views.camera.project(views.a * point).homogeneous();
    const Eigen::Vector3d in_b = views.camera.project(views.b * point).homogeneous();
    const Eigen::Vector3d line = f * in_a;
    EXPECT_LT(std::abs(in_b.dot(line)) / line.head<2>().norm(), 1e-9);  // pixels
  }
}

}  // namespace
}  // namespace planecast::slam
