#include "engine/scene/keep_apart.h"

#include <gtest/gtest.h>

#include <numbers>

namespace planecast::engine {
namespace {

/// A box `wide` along its own right and `deep` across, standing on plane 1.
PlacedObject box_at(double x, double y, double wide, double deep, double turn = 0.0) {
  PlacedObject placed;
  placed.anchor.plane_id = 1;
  placed.sides = Eigen::Vector3d(wide, 0.1, deep);
  slam::Pose& pose = placed.anchor.plane_from_anchor;
  pose.translation() = Eigen::Vector3d(x, y, 0.0);
  // The model's y is the plane's normal.
  pose.linear() = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return placed;
}

bool apart(const PlacedObject& a, const PlacedObject& b) {
  return way_out(base_of(a), base_of(b), 0.0) == Eigen::Vector2d::Zero();
}

Eigen::Vector2d place_of(const PlacedObject& placed) {
  return placed.anchor.plane_from_anchor.translation().head<2>();
}

TEST(KeepApart, LaterGivesWayByTheShortestWay) {
  PlacedObject first = box_at(0, 0, 1.0, 1.0);
  PlacedObject second = box_at(0.8, 0.1, 1.0, 1.0);
  keep_apart({{&first}, {&second}});
  EXPECT_EQ(place_of(first), Eigen::Vector2d(0, 0));
  // 0.2 of overlap along x, and a gap of 4 % of the side.
  EXPECT_LT((place_of(second) - Eigen::Vector2d(1.04, 0.1)).norm(), 1e-9);
}

TEST(KeepApart, BoundsCountNotCircles) {
  // Two long boards side by side: their circles would overlap.
  PlacedObject first = box_at(0, 0, 2.0, 0.2);
  PlacedObject second = box_at(0, 0.25, 2.0, 0.2);
  keep_apart({{&first}, {&second}});
  EXPECT_EQ(place_of(second), Eigen::Vector2d(0, 0.25));
  // Turned by a right angle the second crosses the first.
  PlacedObject across = box_at(0, 0.25, 2.0, 0.2, std::numbers::pi / 2.0);
  keep_apart({{&first}, {&across}});
  EXPECT_TRUE(apart(first, across));
}

TEST(KeepApart, FindsRoomBetweenOthers) {
  PlacedObject left = box_at(-0.6, 0, 1.0, 1.0);
  PlacedObject right = box_at(0.6, 0, 1.0, 1.0);
  PlacedObject third = box_at(0, 0, 1.0, 1.0);
  keep_apart({{&left}, {&right}, {&third}});
  EXPECT_TRUE(apart(left, third));
  EXPECT_TRUE(apart(right, third));
  EXPECT_LT(place_of(third).norm(), 1.6);
}

TEST(KeepApart, StacksGoWithWhatCarriesThem) {
  PlacedObject first = box_at(0, 0, 1.0, 1.0);
  PlacedObject second = box_at(0.8, 0.0, 1.0, 1.0);
  PlacedObject upper = box_at(0.9, 0.1, 0.4, 0.4);
  keep_apart({{&first}, {&second}, {&upper, 1}});
  EXPECT_LT((place_of(upper) - place_of(second) - Eigen::Vector2d(0.1, 0.1)).norm(), 1e-9);
}

TEST(KeepApart, OtherPlanesDoNotMatter) {
  PlacedObject first = box_at(0, 0, 1.0, 1.0);
  PlacedObject second = box_at(0, 0, 1.0, 1.0);
  second.anchor.plane_id = 2;
  keep_apart({{&first}, {&second}});
  EXPECT_EQ(place_of(second), Eigen::Vector2d(0, 0));
}

}  // namespace
}  // namespace planecast::engine
