#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "planes_world.h"
#include "slam/geometry/plane_geometry.h"
#include "slam/geometry/point_clusters.h"

namespace planecast::slam {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A plane through `origin` with normal `normal`, its x axis along `x`.
Plane make_plane(const Vector3d& normal, const Vector3d& origin, const Vector3d& x) {
  Plane plane;
  plane.normal = normal.normalized();
  plane.offset = -plane.normal.dot(origin);
  plane.origin = origin;
  plane.x_axis = x.normalized();
  return plane;
}

const Plane kFloor = make_plane(Vector3d::UnitZ(), Vector3d::Zero(), Vector3d::UnitX());

std::vector<Vector2d> flat(const std::vector<Vector3d>& ring) {
  std::vector<Vector2d> result;
  for (const Vector3d& p : ring) result.push_back(p.head<2>());
  return result;
}

TEST(FitPlane, RecoversATiltedPlaneAndItsNoise) {
  auto generator = test_generator();
  const Vector3d a(1, 0.2, 0.1);
  const Vector3d b(-0.1, 1, 0.3);
  const double noise = 0.01;
  const auto points = strew(generator, 2000, {1, 2, 3}, a, b, noise);
  const auto fit = fit_plane(points);
  ASSERT_TRUE(fit);
  // The slopes' standard deviation is noise sqrt(12 / 2000) per unit length; five of them.
  EXPECT_GT(std::abs(fit->plane.normal.dot(a.cross(b).normalized())),
            std::cos(5.0 * noise * std::sqrt(0.006)));
  EXPECT_NEAR(fit->rms, noise, 0.1 * noise);
  EXPECT_NEAR(fit->plane.signed_distance(fit->centroid), 0.0, 1e-12);
}

TEST(FitPlane, RefusesLinesAndTooFewPoints) {
  EXPECT_FALSE(fit_plane({{0, 0, 0}, {1, 1, 1}}));
  EXPECT_FALSE(fit_plane({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}));
  EXPECT_FALSE(fit_plane(std::vector<Vector3d>(10, Vector3d(1, 2, 3))));
}

TEST(FitPlane, WeightsCount) {
  std::vector<Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 1}};
  const auto fit = fit_plane(points, {0, 1, 2, 3, 4}, {1, 1, 1, 1, 1e-12});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(std::abs(fit->plane.normal.z()), 1.0, 1e-9);
  EXPECT_NEAR(fit->plane.offset, 0.0, 1e-9);
}

TEST(IntersectRay, MeetsThePlaneAheadOnly) {
  const PlaneEquation plane{Vector3d::UnitZ(), -2.0};
  EXPECT_DOUBLE_EQ(*intersect_ray(plane, {0, 0, 0}, {0, 0, 0.5}), 4.0);
  EXPECT_FALSE(intersect_ray(plane, {0, 0, 0}, {0, 0, -1}));
  EXPECT_FALSE(intersect_ray(plane, {0, 0, 0}, {1, 0, 0}));
}

TEST(ContainsPoint, KnowsHoles) {
  const std::vector<Vector2d> outer = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  const std::vector<Vector2d> hole = {{1, 1}, {1, 2}, {2, 2}, {2, 1}};
  EXPECT_DOUBLE_EQ(signed_area(outer), 16.0);
  EXPECT_DOUBLE_EQ(signed_area(hole), -1.0);
  EXPECT_TRUE(contains_point(outer, {hole}, {3, 3}));
  EXPECT_FALSE(contains_point(outer, {hole}, {1.5, 1.5}));
  EXPECT_FALSE(contains_point(outer, {hole}, {5, 1}));
  EXPECT_FALSE(contains_point({}, {}, {0, 0}));
}

TEST(ClusterPoints, SplitsAtGapsAndNumbersBySize) {
  auto generator = test_generator();
  auto points = strew(generator, 60, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0);
  const auto far = strew(generator, 100, {3, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0);
  points.insert(points.end(), far.begin(), far.end());
  const std::vector<int> cluster = cluster_points(points, 0.5);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(cluster[i], 1);
  for (int i = 60; i < 160; ++i) EXPECT_EQ(cluster[i], 0);
  EXPECT_TRUE(cluster_points({}, 1.0).empty());
}

TEST(PlaneExtent, OfFortyPointsIsOnePatchOfAboutTheTablesArea) {
  auto generator = test_generator();
  for (int trial = 0; trial < 20; ++trial) {
    const auto points = strew(generator, 40, {-0.6, -0.4, 0}, {1.2, 0, 0}, {0, 0.8, 0}, 0.004);
    const PlaneExtent extent = plane_extent(kFloor, points, 0.0);
    ASSERT_GE(extent.outer.size(), 3U);
    // The outermost of 40 points lie about half a spacing (0.15) within the edge, and the outline
    // is concave: at least half of the table is covered, and it reaches hardly beyond the edge.
    EXPECT_GT(extent.area, 0.5 * 0.96) << "trial " << trial;
    EXPECT_LT(extent.area, 1.15 * 0.96) << "trial " << trial;
    EXPECT_GT(signed_area(flat(extent.outer)), 0.0);
    int inside = 0;
    for (const Vector3d& p : points) inside += contains_point(flat(extent.outer), {}, p.head<2>());
    // A corner point or two may hang by less than the linking distance.
    EXPECT_GE(inside, 32) << "trial " << trial;
  }
}

TEST(PlaneExtent, DoesNotReachForStrays) {
  auto generator = test_generator();
  auto points = strew(generator, 200, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0);
  const double alone = plane_extent(kFloor, points, 0.0).area;
  points.emplace_back(8, 8, 0);
  points.emplace_back(-50, 3, 0);
  const PlaneExtent extent = plane_extent(kFloor, points, 0.0);
  EXPECT_NEAR(extent.area, alone, 0.05 * alone);
  for (const Vector3d& p : extent.outer) EXPECT_LT(p.norm(), 2.0);
}

TEST(PlaneExtent, KeepsHolesAndCornersThatTurnInwards) {
  auto generator = test_generator();
  // An L of three unit squares with a hole of 0.4 x 0.4 in one of them.
  std::vector<Vector3d> points;
  for (const Vector3d& p : strew(generator, 4000, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}, 0.0)) {
    const bool in_notch = p.x() > 1.0 && p.y() > 1.0;
    const bool in_hole = std::abs(p.x() - 0.5) < 0.2 && std::abs(p.y() - 0.5) < 0.2;
    if (!in_notch && !in_hole) points.push_back(p);
  }
  const PlaneExtent extent = plane_extent(kFloor, points, 0.0);
  ASSERT_EQ(extent.holes.size(), 1U);
  EXPECT_LT(signed_area(flat(extent.holes[0])), 0.0);
  EXPECT_NEAR(extent.area, 3.0 - 0.16, 0.1);
  const auto outer = flat(extent.outer);
  EXPECT_FALSE(contains_point(outer, {flat(extent.holes[0])}, {0.5, 0.5}));
  EXPECT_FALSE(contains_point(outer, {}, {1.5, 1.5}));
  EXPECT_TRUE(contains_point(outer, {}, {1.5, 0.5}));
}

TEST(PlaneExtent, LiesOnThePlaneAndTurnsLeftSeenFromTheNormal) {
  auto generator = test_generator();
  const Vector3d a(1, 0, 0);
  const Vector3d b(0, 0.6, 0.8);
  const auto points = strew(generator, 300, {2, 1, 5}, a, b, 0.01);
  const Vector3d normal = -a.cross(b);
  const Plane plane = make_plane(normal, {2, 1, 5}, a);
  const PlaneExtent extent = plane_extent(plane, points, 0.0);
  ASSERT_GE(extent.outer.size(), 3U);
  Vector3d doubled = Vector3d::Zero();
  for (std::size_t i = 0; i < extent.outer.size(); ++i) {
    EXPECT_NEAR(plane.signed_distance(extent.outer[i]), 0.0, 1e-12);
    doubled += extent.outer[i].cross(extent.outer[(i + 1) % extent.outer.size()]);
  }
  EXPECT_GT(doubled.dot(plane.normal), 0.0);
  EXPECT_NEAR(0.5 * doubled.norm(), extent.area, 1e-9);
}

TEST(PlaneExtent, OfTooLittleIsEmpty) {
  EXPECT_TRUE(plane_extent(kFloor, {}, 0.1).outer.empty());
  EXPECT_TRUE(plane_extent(kFloor, {{0, 0, 0}, {1, 0, 0}}, 0.1).outer.empty());
  EXPECT_TRUE(
      plane_extent(kFloor, std::vector<Vector3d>(50, Vector3d(1, 1, 0)), 0.0).outer.empty());
}

TEST(Plane, RefitsMoveItsFrameAlongTheNormalAndByTheSmallestRotation) {
  Plane plane = make_plane({0, 0, 1}, {1, 2, 0}, {1, 0, 0});
  const Vector3d normal = Eigen::AngleAxisd(0.1, Vector3d::UnitX()) * Vector3d::UnitZ();
  plane.refit(normal, -0.05);
  EXPECT_NEAR(plane.signed_distance(plane.origin), 0.0, 1e-12);
  EXPECT_NEAR((plane.origin - Vector3d(1, 2, 0)).cross(normal).norm(), 0.0, 1e-12);
  // The turn is about x, which therefore stays.
  EXPECT_LT((plane.x_axis - Vector3d::UnitX()).norm(), 1e-12);
  const Pose world_from_plane = plane.world_from_plane();
  EXPECT_NEAR(world_from_plane.linear().determinant(), 1.0, 1e-12);
  EXPECT_LT((world_from_plane * Vector3d(0, 0, 1) - plane.origin - normal).norm(), 1e-12);
}

}  // namespace
}  // namespace planecast::slam
