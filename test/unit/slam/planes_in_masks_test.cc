// What masks are trusted with and what not.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "planes_mapping_tools.h"
#include "planes_world.h"
#include "slam/stages/map_planes.h"
#include "slam/stages/plane_steps.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;

/// A mask over the whole image.
cv::Mat whole_image(int label) { return {480, 640, CV_16U, cv::Scalar(label)}; }

/// A wall of 120 landmarks in mask 1, to which more is added; and the planes that two keyframes
/// find in it.
struct WallInMask {
  std::mt19937 generator = test_generator();
  MapBuilder builder{test_camera()};
  std::vector<KeyframeId> views = add_pair(builder, {0, 0, 0}, {0, 0, 2});

  WallInMask() { add(120, {-0.6, -0.5, 2.0}, {0.9, 0, 0}, {0, 1, 0}); }
  void add(int count, const Vector3d& corner, const Vector3d& a, const Vector3d& b) {
    add_all(builder, strew(generator, count, corner, a, b, 0.004), views, 1);
  }
  Map mapped() {
    Map map = builder.build();
    PlaneMapper mapper = mono_mapper();
    map_planes(map, {0, 1, 1}, mapper);
    return map;
  }
};

TEST(PlanesInMasks, WhatLeakedInIsNoPlane) {
  WallInMask wall;
  // A fifth of the mask is a strip of the floor, which goes on in a mask of its own.
  wall.add(30, {-0.4, 0.6, 1.5}, {0.8, 0, 0}, {0, 0, 0.25});
  const Map map = wall.mapped();
  ASSERT_EQ(map.planes.size(), 1U);
  EXPECT_EQ(count_matching(map, -Vector3d::UnitZ(), {0, 0, 2.0}, 0.01), 1);
}

TEST(PlanesInMasks, OneMaskOverTwoPlanesHoldsBoth) {
  WallInMask wall;
  wall.add(80, {-0.5, 0.6, 1.3}, {1, 0, 0}, {0, 0, 0.6});
  const Map map = wall.mapped();
  EXPECT_EQ(map.planes.size(), 2U);
  EXPECT_EQ(count_matching(map, kUp, {0, 0.6, 1.6}, 0.01), 1);
}

TEST(PlanesInMasks, FewFeaturesFarApartMakeAPlane) {
  MapBuilder builder(test_camera());
  const auto views = add_pair(builder, {0, 0, 0}, {0, 0, 2});
  // Further apart than the 6 eps_d = 24 cm that connect points without a mask.
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 5; ++col) {
      builder.add_landmark({-0.68 + 0.34 * col, -0.51 + 0.34 * row, 2.0}, views, 1);
    }
  }
  Map map = builder.build();
  PlaneMapper mapper = mono_mapper();
  map_planes(map, {0, 1, 1}, mapper);
  EXPECT_EQ(count_matching(map, -Vector3d::UnitZ(), {0, 0, 2.0}, 0.01), 1);
}

TEST(PlanesInMasks, LandmarksThatAreNotFoundAgainSpeakForTheirMask) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  const Vector3d ahead(0, 0, 2);
  const auto views = add_pair(builder, {0, 0, 0}, ahead);
  const KeyframeId last = builder.add_keyframe(look_at({0.05, 0, 0}, ahead));
  const auto wall = strew(generator, 40, {-0.5, -0.4, 2.0}, {1, 0, 0}, {0, 0.8, 0}, 0.003);
  // The last keyframe finds eight of them: too few for a plane.
  for (int i = 0; i < 40; ++i) {
    std::vector<KeyframeId> observers = views;
    if (i < 8) observers.push_back(last);
    builder.add_landmark(wall[i], observers, i < 8 ? 1 : 0);
  }
  Map map = builder.build();
  map.keyframes.at(last).label_image = whole_image(1);
  PlaneMapper mapper = mono_mapper();
  map_planes(map, {last}, mapper);
  ASSERT_EQ(map.planes.size(), 1U);
  EXPECT_EQ(count_matching(map, -Vector3d::UnitZ(), ahead, 0.01), 1);
  EXPECT_GT((*map.planes.begin()).inliers, 30);
}

TEST(PlanesInMasks, LandmarksSeenFromElsewhereStayOut) {
  auto generator = test_generator();
  MapBuilder builder(test_camera());
  // Seen from the side, where nothing tells whether the last keyframe sees them too.
  const auto aside = add_pair(builder, {2.0, 0, 0.5}, {0, 0, 2});
  const KeyframeId last = builder.add_keyframe(look_at({0, 0, 0}, {0, 0, 2}));
  add_all(builder, strew(generator, 40, {-0.5, -0.4, 2.0}, {1, 0, 0}, {0, 0.8, 0}, 0.003), aside,
          0);
  add_all(builder, strew(generator, 8, {-0.5, -0.4, 2.0}, {1, 0, 0}, {0, 0.8, 0}, 0.003), {last},
          1);
  Map map = builder.build();
  map.keyframes.at(last).label_image = whole_image(1);
  const PlaneContext context{PlaneMappingOptions(), {0.04, 0.02, 0.04}, test_camera(), false};
  const KeyframePoints shown = gather_points(map, last, context);
  EXPECT_EQ(shown.size(), 8);
  EXPECT_EQ(shown.observed, 8);
}

TEST(PlanesInMasks, ManyKeyframesMakeUpForFewLandmarks) {
  const PlaneMappingOptions options;
  PlaneContext context{options, {}, test_camera()};
  Plane plane;
  plane.label = 1;
  plane.observers = {0, 1};
  EXPECT_EQ(strong_support(plane, context), options.strong_inliers);
  plane.observers = {0, 1, 2, 3, 4};
  EXPECT_EQ(strong_support(plane, context), 18);
  plane.label = 0;
  EXPECT_EQ(strong_support(plane, context), 2 * options.strong_inliers);
  context.finished = true;
  EXPECT_EQ(strong_support(plane, context), 24);
}

TEST(PlanesInMasks, ASlabOfClutterStaysWeakThoughAMaskShowsIt) {
  auto generator = test_generator();
  std::uniform_real_distribution<double> height(-0.04, 0.04);
  PlanePoints support;
  for (const Vector3d& p : strew(generator, 200, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0)) {
    support.positions.push_back(p + height(generator) * Vector3d::UnitZ());
    support.view_from.push_back(Vector3d::UnitZ());
    support.band.push_back(1.0);
  }
  Plane plane;
  plane.label = 1;
  PlaneContext context{PlaneMappingOptions(), {0.04, 0.02, 0.04}, test_camera(), false};
  EXPECT_TRUE(may_be_slab(plane, support, context));
  context.young = true;
  EXPECT_FALSE(may_be_slab(plane, support, context));
}

}  // namespace
}  // namespace planecast::slam
