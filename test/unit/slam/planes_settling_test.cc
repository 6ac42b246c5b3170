#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "planes_mapping_tools.h"
#include "planes_world.h"
#include "slam/fitting/plane_mixture.h"
#include "slam/stages/plane_plausibility.h"
#include "slam/stages/plane_steps.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;

void add(const std::vector<Vector3d>& positions, const Vector3d& view_from, PlanePoints& points) {
  for (const Vector3d& p : positions) {
    points.positions.push_back(p);
    points.view_from.push_back(view_from);
    points.band.push_back(1.0);
  }
}

/// A square metre at z = 0 that is seen from above.
PlanePoints sheet(std::mt19937& generator) {
  PlanePoints points;
  add(strew(generator, 200, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.001), Vector3d::UnitZ(), points);
  return points;
}

constexpr double kEps = 0.01;
const PlaneScale kScale{0.04, 0.02, 0.04};
const PlaneEquation kGround{Vector3d::UnitZ(), 0.0};

TEST(SeenThrough, CountsWhatLiesBehind) {
  auto generator = test_generator();
  PlanePoints points = sheet(generator);
  EXPECT_EQ(count_seen_through(kGround, points, kEps, kScale).through, 0);
  add(strew(generator, 40, {0.1, 0.1, -0.02}, {0.8, 0, 0}, {0, 0.8, 0}, 0.001), Vector3d::UnitZ(),
      points);
  const SeenThrough seen = count_seen_through(kGround, points, kEps, kScale);
  EXPECT_EQ(seen.on_plane, 200);
  EXPECT_LE(seen.through, 40);
  EXPECT_GE(seen.through, 28) << "but for those whose ray meets less than two points";
}

TEST(SeenThrough, LeavesOutWhatIsSeenFromBehindOrPastTheEdge) {
  auto generator = test_generator();
  PlanePoints points = sheet(generator);
  add(strew(generator, 40, {0.1, 0.1, -0.02}, {0.8, 0, 0}, {0, 0.8, 0}, 0.001), -Vector3d::UnitZ(),
      points);
  add(strew(generator, 40, {1.2, 0, -0.02}, {1, 0, 0}, {0, 1, 0}, 0.001), Vector3d::UnitZ(),
      points);
  EXPECT_EQ(count_seen_through(kGround, points, kEps, kScale).through, 0);
}

TEST(SeenThrough, OfNothingIsNothing) {
  const SeenThrough seen = count_seen_through(kGround, PlanePoints(), kEps, kScale);
  EXPECT_EQ(seen.on_plane, 0);
  EXPECT_EQ(seen.through, 0);
}

/// A desk whose texture is a magazine at one end, with things three to six centimetres high beside
/// it: more of them than of the magazine.
TEST(SettlePlanes, ThingsThatLieOnADeskDoNotTiltIt) {
  for (int trial = 0; trial < 5; ++trial) {
    auto generator = test_generator();
    generator.discard(static_cast<unsigned long long>(1000 * trial));
    std::uniform_real_distribution<double> height(0.03, 0.06);
    MapBuilder builder(test_camera());
    const auto views = add_pair(builder, {0, -0.2, 0}, {0, 0.6, 2.0});
    add_all(builder, strew(generator, 150, {-0.6, 0.6, 1.5}, {0.7, 0, 0}, {0, 0, 0.8}, 0.001),
            views, 0);
    for (const Vector3d& foot :
         strew(generator, 200, {0.15, 0.6, 1.5}, {0.45, 0, 0}, {0, 0, 0.8}, 0.0)) {
      builder.add_landmark(foot + height(generator) * kUp, views, 0);
    }
    Map map = builder.build();
    Plane tilted;
    tilted.id = map.planes.next_id();
    std::vector<Vector3d> all;
    for (Landmark& landmark : map.landmarks) {
      landmark.plane = tilted.id;
      all.push_back(landmark.position);
    }
    PlaneEquation fit = fit_plane(all)->plane;
    if (fit.normal.dot(kUp) < 0.0) fit = fit.flipped();
    tilted.refit(fit.normal, fit.offset);
    ASSERT_GT(angle_deg(tilted.normal, kUp), 1.5) << trial;
    const PlaneId id = tilted.id;
    map.planes.put(std::move(tilted));

    PlaneContext context{PlaneMappingOptions(), kScale, test_camera(), false};
    context.finished = true;
    EXPECT_EQ(settle_planes(map, context), 1);
    const Plane& settled = map.planes.at(id);
    EXPECT_LT(angle_deg(settled.normal, kUp), 0.5) << trial;
    EXPECT_NEAR(settled.signed_distance({-0.2, 0.6, 1.9}), 0.0, 0.003) << trial;
    EXPECT_LT(settled.inliers, 180) << "what stands up from it is let go";
    EXPECT_GE(settled.inliers, 145) << trial;
  }
}

TEST(PlaneMixture, HoldsDownWhatMayBeBehind) {
  auto generator = test_generator();
  PlanePoints points;
  // Twice as many points two centimetres above the ground as on it.
  add(strew(generator, 100, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.002), Vector3d::UnitZ(), points);
  add(strew(generator, 200, {0, 0, 0.02}, {1, 0, 0}, {0, 1, 0}, 0.002), Vector3d::UnitZ(), points);
  std::vector<int> all(points.positions.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  const std::vector<PlaneEquation> starts = {kGround, {Vector3d::UnitZ(), -0.02}};
  PlaneMixtureOptions options;
  options.reach = 0.08;
  options.min_sigma = options.max_sigma = 0.003;
  EXPECT_NEAR(fit_plane_mixture(points, all, starts, options)->plane.offset, -0.02, 0.001);
  options.max_behind = 0.02;
  const auto lowest = fit_plane_mixture(points, all, starts, options);
  EXPECT_NEAR(lowest->plane.offset, 0.0, 0.001);
  EXPECT_LE(lowest->behind, 0.02);
}

}  // namespace
}  // namespace planecast::slam
