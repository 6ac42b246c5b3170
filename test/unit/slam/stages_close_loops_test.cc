#include "slam/stages/close_loops.h"

#include <gtest/gtest.h>

#include "test/unit/slam/ring_world.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

LoopOptions options_for(bool rgbd) {
  LoopOptions options;
  options.rgbd = rgbd;
  options.verify.with_scale = !rgbd;
  return options;
}

std::shared_ptr<const Vocabulary> vocabulary_of(const Map& map) {
  std::vector<std::vector<Descriptor>> images;
  for (const Keyframe& keyframe : map.keyframes) images.push_back(keyframe.features->descriptors);
  VocabularyTraining training;
  training.depth = 4;
  return std::make_shared<const Vocabulary>(train_vocabulary(images, training));
}

/// True length of a unit of the map: the scale of the best alignment of all cameras. In mono it is
/// free, and a corrected map has another one than its first keyframes had.
double unit_of(const Map& map, const RingWorld& world) {
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const Keyframe& keyframe : map.keyframes) {
    const auto index = static_cast<std::size_t>(keyframe.id);
    estimated.push_back(keyframe.centre_world());
    truth.push_back(world.true_cam_from_world[index].inverse().translation());
  }
  return align_points(estimated, truth, true).scale;
}

/// Distance from the truth of a point, as seen from the first camera.
double error_of(const Eigen::Vector3d& estimated, const Eigen::Vector3d& truth, const Map& map,
                const RingWorld& world) {
  const Pose origin = map.keyframes.at(0).cam_from_world;
  return (unit_of(map, world) * (origin * estimated) - origin * truth).norm();
}

double position_error(const Map& map, const RingWorld& world, KeyframeId id) {
  const Pose& truth = world.true_cam_from_world[static_cast<std::size_t>(id)];
  return error_of(map.keyframes.at(id).centre_world(), truth.inverse().translation(), map, world);
}

/// Mean distance of landmarks from the truth.
double landmark_error(const Map& map, const RingWorld& world) {
  double sum = 0.0;
  for (const Landmark& landmark : map.landmarks) {
    const auto index = static_cast<std::size_t>(landmark.id);
    sum += error_of(landmark.position, world.true_points[index], map, world);
  }
  return sum / static_cast<double>(map.landmarks.size());
}

/// Adds keyframe after keyframe until one closes a loop.
std::optional<LoopMatch> find_loop(RingBuilder& builder, const RingOptions& ring,
                                   const LoopOptions& options,
                                   std::shared_ptr<const Vocabulary> vocabulary) {
  LoopFinder finder(options, builder.world().camera, std::move(vocabulary));
  for (int k = 0; k < ring.round + ring.extra - 2; ++k) {
    builder.add_keyframe(k);
    auto match = finder.look(builder.world().map, k);
    if (match) return match;
  }
  return std::nullopt;
}

/// Of another walk through the same world.
std::shared_ptr<const Vocabulary> vocabulary_of(const RingOptions& ring) {
  Random random(seed_of("ClosedLoop"));
  RingBuilder builder(ring, random);
  for (int k = 0; k < ring.round; ++k) builder.add_keyframe(k);
  return vocabulary_of(builder.world().map);
}

class ClosedLoop : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    ring_.depth = GetParam();
    if (ring_.depth) ring_.scale_drift = 0.0;
    builder_ = std::make_unique<RingBuilder>(ring_, random_);
    match_ = find_loop(*builder_, ring_, options_for(ring_.depth), vocabulary_of(ring_));
    ASSERT_TRUE(match_);
    last_ = match_->keyframe;
  }
  const Map& map() { return builder_->world().map; }

  Random random_{seed_of("ClosedLoop")};
  RingOptions ring_;
  std::unique_ptr<RingBuilder> builder_;
  std::optional<LoopMatch> match_;
  KeyframeId last_ = kNone;
};

TEST_P(ClosedLoop, IsFoundWhereItIs) {
  // The image is 62 degrees wide, seven steps: nothing of the beginning is seen before.
  EXPECT_GE(match_->keyframe, ring_.round - 7);
  EXPECT_LE(std::abs(match_->keyframe - ring_.round - match_->loop_keyframe), 7);
  const auto& truth = builder_->world().true_cam_from_world;
  const Pose expected = truth[static_cast<std::size_t>(match_->keyframe)] *
                        truth[static_cast<std::size_t>(match_->loop_keyframe)].inverse();
  Pose found = Pose::Identity();
  found.linear() = match_->cam_from_loop_cam.rotation;
  EXPECT_LT(rotation_error_deg(found, expected), 0.2);
  // The scale that has drifted since.
  const double steps = match_->keyframe - match_->loop_keyframe;
  EXPECT_NEAR(std::log(match_->cam_from_loop_cam.scale), ring_.scale_drift * steps, 0.01);
  if (GetParam()) {
    EXPECT_EQ(match_->cam_from_loop_cam.scale, 1.0);
  }
}

TEST_P(ClosedLoop, TheEndPointErrorFallsFivefold) {
  const RingWorld& world = builder_->world();
  const double before = position_error(map(), world, last_);
  const auto correction = correct_loop(map(), world.camera, *match_, options_for(GetParam()));
  ASSERT_TRUE(correction);
  EXPECT_LT(5.0 * position_error(correction->map, world, last_), before);
  // Landmarks also have noise of their own, which stays.
  EXPECT_LT(2.0 * landmark_error(correction->map, world), landmark_error(map(), world));
  EXPECT_LT(correction->map.landmarks.size(), map().landmarks.size());
  // The origin stays.
  EXPECT_EQ(correction->map.keyframes.at(0).cam_from_world.matrix(),
            map().keyframes.at(0).cam_from_world.matrix());
}

TEST_P(ClosedLoop, IsTheSameToTheBitTwice) {
  const Camera& camera = builder_->world().camera;
  const auto a = correct_loop(map(), camera, *match_, options_for(GetParam()));
  const auto b = correct_loop(map(), camera, *match_, options_for(GetParam()));
  ASSERT_TRUE(a && b);
  for (const Keyframe& keyframe : a->map.keyframes) {
    EXPECT_EQ(keyframe.cam_from_world.matrix(),
              b->map.keyframes.at(keyframe.id).cam_from_world.matrix());
  }
}

TEST_P(ClosedLoop, WhatWasAddedMeanwhileComesAlong) {
  RingWorld& world = builder_->world();
  const auto correction = correct_loop(map(), world.camera, *match_, options_for(GetParam()));
  ASSERT_TRUE(correction);
  builder_->add_keyframe(last_ + 1);
  builder_->add_keyframe(last_ + 2);
  const double before = position_error(world.map, world, last_ + 2);
  // A frame that was tracked relative to a keyframe keeps its place in the world.
  const KeyframeId reference = last_ + 1;
  const Pose true_step = world.true_cam_from_world[static_cast<std::size_t>(reference + 1)] *
                         world.true_cam_from_world[static_cast<std::size_t>(reference)].inverse();
  const Pose relative = world.map.relative_to_keyframe(
      world.map.keyframes.at(reference + 1).cam_from_world, reference);
  carry_over(*correction, world.camera, options_for(GetParam()), world.map);
  EXPECT_LT(5.0 * position_error(world.map, world, last_ + 2), before);
  EXPECT_EQ(world.map.loop_edges.size(), 1U);
  const Pose carried = world.map.from_keyframe(relative, reference) *
                       world.map.keyframes.at(reference).cam_from_world.inverse();
  // The turn of one step's drift stays, its length is the true one to 1 %.
  const double length = unit_of(world.map, world) * carried.translation().norm();
  EXPECT_NEAR(length / true_step.translation().norm(), 1.0, 0.01);
}

TEST_P(ClosedLoop, PlanesGoAlongWithTheirKeyframes) {
  const RingWorld& world = builder_->world();
  Map with_plane = map();
  // A plane born late in the round, through three landmarks of that keyframe as the map has them.
  const KeyframeId birth = ring_.round - 10;
  std::vector<LandmarkId> corners;
  for (const LandmarkId id : with_plane.keyframes.at(birth).landmarks) {
    if (with_plane.landmarks.at(id).first_keyframe == birth) corners.push_back(id);
  }
  ASSERT_GE(corners.size(), 3U);
  const auto equation = [&](const auto& position_of, Eigen::Vector3d& normal) {
    const Eigen::Vector3d a = position_of(corners[0]);
    const Eigen::Vector3d b = position_of(corners[corners.size() / 2]);
    const Eigen::Vector3d c = position_of(corners.back());
    normal = (b - a).cross(c - a).normalized();
    return a;
  };
  Plane plane;
  plane.id = 0;
  plane.observers = {birth};
  plane.origin =
      equation([&](LandmarkId id) { return with_plane.landmarks.at(id).position; }, plane.normal);
  plane.offset = -plane.normal.dot(plane.origin);
  plane.x_axis = plane.normal.unitOrthogonal();
  with_plane.planes.put(plane);
  Eigen::Vector3d true_normal;
  const Eigen::Vector3d true_origin = equation(
      [&](LandmarkId id) { return world.true_points[static_cast<std::size_t>(id)]; }, true_normal);

  const auto correction = correct_loop(with_plane, world.camera, *match_, options_for(GetParam()));
  ASSERT_TRUE(correction);
  Map carried = with_plane;
  carry_over(*correction, world.camera, options_for(GetParam()), carried);
  const Plane& moved = carried.planes.at(0);
  EXPECT_NEAR(moved.signed_distance(moved.origin), 0.0, 1e-9);
  EXPECT_NEAR(moved.x_axis.dot(moved.normal), 0.0, 1e-9);
  EXPECT_LT(2.0 * error_of(moved.origin, true_origin, carried, world),
            error_of(plane.origin, true_origin, with_plane, world));
  EXPECT_LT(2.0 * direction_error_deg(moved.normal, true_normal),
            direction_error_deg(plane.normal, true_normal));
}

INSTANTIATE_TEST_SUITE_P(MonoAndDepth, ClosedLoop, ::testing::Bool());

TEST(LoopFinder, TakesNoPlaceForAnother) {
  Random random(seed_of("LoopFinder.TakesNoPlaceForAnother"));
  RingOptions ring;
  RingBuilder builder(ring, random);
  for (int k = 0; k < ring.round; ++k) builder.add_keyframe(k);
  const Map& map = builder.world().map;
  for (const KeyframeId other : {5, 15, 25}) {
    EXPECT_FALSE(verify_loop(map, builder.world().camera, ring.round - 5, other, {}));
  }
}

}  // namespace
}  // namespace planecast::slam
