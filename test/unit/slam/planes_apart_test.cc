// Which planes stay apart and which become one.
#include <gtest/gtest.h>

#include <vector>

#include "planes_mapping_tools.h"
#include "planes_world.h"
#include "slam/stages/map_planes.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;

/// Two tables of one height, 0.6 apart, in masks of their own or without.
void add_two_tables(MapBuilder& builder, std::mt19937& generator,
                    const std::vector<KeyframeId>& views, bool masks) {
  add_all(builder, strew(generator, 120, {-1.0, 0.6, 1.6}, {0.7, 0, 0}, {0, 0, 0.6}, 0.004), views,
          masks ? 1 : 0);
  add_all(builder, strew(generator, 120, {0.3, 0.6, 1.6}, {0.7, 0, 0}, {0, 0, 0.6}, 0.004), views,
          masks ? 2 : 0);
}

class TwoTables : public ::testing::TestWithParam<bool> {};

TEST_P(TwoTables, OfOneHeightStayTwo) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const auto views = add_pair(builder, {0, 0, 0}, {0, 0.5, 2.0});
  add_two_tables(builder, generator, views, GetParam());
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  map_planes(map, {0, 1, 1}, mapper);
  ASSERT_EQ(map.planes.size(), 2U);
  EXPECT_EQ(count_matching(map, kUp, {0, 0.6, 1.9}, 0.01), 2);
  for (const Plane& plane : map.planes) EXPECT_GT(plane.inliers, 110);
}

TEST_P(TwoTables, StayTwoWhenTheMapIsFinished) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const auto views = add_pair(builder, {0, 0, 0}, {0, 0.5, 2.0});
  const bool masks = GetParam();
  add_two_tables(builder, generator, views, masks);
  // Either masks tell them apart or the floor that is seen between them.
  if (!masks) {
    add_all(builder, strew(generator, 40, {-0.4, 1.2, 2.4}, {0.8, 0, 0}, {0, 0, 1.5}, 0.004), views,
            0);
  }
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  PlaneMappingStats stats = map_planes(map, {0, 1, 1}, mapper);
  mapper.finish(map, stats);
  EXPECT_EQ(count_matching(map, kUp, {0, 0.6, 1.9}, 0.01), 2);
}

INSTANTIATE_TEST_SUITE_P(Masks, TwoTables, ::testing::Bool());

TEST(PlaneMapper, PicturesOnABareWallAreOneWallWhenTheMapIsFinished) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const auto views = add_pair(builder, {0, 0, 0}, {0, 0, 2});
  for (const double x : {-1.0, 0.5}) {
    add_all(builder, strew(generator, 120, {x, -0.3, 2.0}, {0.5, 0, 0}, {0, 0.6, 0}, 0.004), views,
            0);
  }
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  PlaneMappingStats stats = map_planes(map, {0, 1, 1}, mapper);
  ASSERT_EQ(map.planes.size(), 2U);
  mapper.finish(map, stats);
  EXPECT_EQ(map.planes.size(), 1U);
  EXPECT_EQ(count_matching(map, -Vector3d::UnitZ(), {0, 0, 2.0}, 0.005), 1);
}

TEST(PlaneMapper, FewPreciseLandmarksAreAPlaneWhenTheMapIsFinished) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  std::vector<KeyframeId> views = add_pair(builder, {0, 0, 0}, {0, 0.5, 2.0});
  for (const KeyframeId view : add_pair(builder, {0.3, 0, 0}, {0, 0.5, 2.0})) views.push_back(view);
  // A growing map asks for sixty where no mask speaks for the plane.
  add_all(builder, strew(generator, 40, {-0.4, 0.6, 1.6}, {0.8, 0, 0}, {0, 0, 0.6}, 0.001), views,
          0);
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  PlaneMappingStats stats = map_planes(map, views, mapper);
  ASSERT_EQ(map.planes.size(), 1U);
  EXPECT_TRUE((*map.planes.begin()).weak);
  mapper.finish(map, stats);
  ASSERT_EQ(map.planes.size(), 1U);
  EXPECT_FALSE((*map.planes.begin()).weak);
}

class Stairs : public ::testing::TestWithParam<bool> {};

TEST_P(Stairs, KeepTheirSteps) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const auto views = add_pair(builder, {0, -0.4, 0}, {0, 0.4, 1.8});
  for (int step = 0; step < 4; ++step) {
    const double y = 0.8 - 0.17 * step;
    const double z = 1.2 + 0.28 * step;
    add_all(builder, strew(generator, 90, {-0.5, y, z}, {1, 0, 0}, {0, 0, 0.28}, 0.003), views,
            GetParam() ? 1 + step : 0);
  }
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  map_planes(map, {0, 1, 1}, mapper);
  EXPECT_EQ(map.planes.size(), 4U);
  for (int step = 0; step < 4; ++step) {
    EXPECT_EQ(count_matching(map, kUp, {0, 0.8 - 0.17 * step, 1.34 + 0.28 * step}, 0.01), 1)
        << step;
  }
}

INSTANTIATE_TEST_SUITE_P(Masks, Stairs, ::testing::Bool());

TEST(PlaneMapper, FacesOfAThinPartitionStaySeparate) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const auto front = add_pair(builder, {0, 0, 0}, {0, 0, 2});
  const auto back = add_pair(builder, {0, 0, 4.02}, {0, 0, 2});
  // Two centimetres apart: half of eps_d at this distance.
  add_all(builder, strew(generator, 150, {-0.6, -0.5, 2.0}, {1.2, 0, 0}, {0, 1, 0}, 0.004), front,
          1);
  add_all(builder, strew(generator, 150, {-0.6, -0.5, 2.02}, {1.2, 0, 0}, {0, 1, 0}, 0.004), back,
          1);
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  map_planes(map, {0, 1, 2, 3, 3}, mapper);
  ASSERT_EQ(map.planes.size(), 2U);
  EXPECT_EQ(count_matching(map, -Vector3d::UnitZ(), {0, 0, 2.0}, 0.005), 1);
  EXPECT_EQ(count_matching(map, Vector3d::UnitZ(), {0, 0, 2.02}, 0.005), 1);
}

TEST(PlaneMapper, OneWallSeenFromTwoEndsMergesAndItsIdSurvives) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const auto left = add_pair(builder, {-2, 0, 0}, {-2, 0, 2});
  const auto right = add_pair(builder, {2, 0, 0}, {2, 0, 2});
  const auto middle = add_pair(builder, {0, 0, 0}, {0, 0, 2});
  const auto strip = [&](double from, double to, int count) {
    return strew(generator, count, {from, -0.5, 2.0}, {to - from, 0, 0}, {0, 1, 0}, 0.005);
  };
  add_all(builder, strip(-2.6, -1.0, 150), left, 1);
  add_all(builder, strip(1.0, 2.6, 150), right, 7);
  add_all(builder, strip(-1.0, 1.0, 200), middle, 3);
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  map_planes(map, {0, 1}, mapper);
  ASSERT_EQ(map.planes.size(), 1U);
  const Vector3d origin = map.planes.at(0).origin;
  map_planes(map, {2, 3}, mapper);
  EXPECT_EQ(map.planes.size(), 2U);
  map_planes(map, {4, 5}, mapper);
  ASSERT_EQ(map.planes.size(), 1U);
  ASSERT_TRUE(map.planes.contains(0));
  const Plane& wall = map.planes.at(0);
  EXPECT_GE(wall.merged_from.size(), 1U);
  EXPECT_GT(wall.inliers, 450);
  // The frame stayed at the first end; it moved along the normal only.
  EXPECT_LT((wall.origin - origin).head<2>().norm(), 0.005);
  EXPECT_EQ(static_cast<int>(map.landmarks_of(0).size()), wall.inliers);
}

TEST(PlaneMapper, PaperMergingJoinsWhatTheDefaultKeepsApart) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const auto views = add_pair(builder, {0, -0.4, 0}, {0, 0.4, 1.8});
  for (int step = 0; step < 2; ++step) {
    add_all(builder,
            strew(generator, 90, {-0.5, 0.8 - 0.17 * step, 1.2 + 0.28 * step}, {1, 0, 0},
                  {0, 0, 0.28}, 0.003),
            views, 1 + step);
  }
  Map map = builder.build();
  PlaneMappingOptions options;
  options.merge = PlaneMerge::kPaper;
  PlaneMapper mapper = mono_mapper(options);
  map_planes(map, {0}, mapper);
  EXPECT_EQ(map.planes.size(), 1U);
}

}  // namespace
}  // namespace planecast::slam
