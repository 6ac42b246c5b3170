#include <gtest/gtest.h>

#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::slam {
namespace {

Camera test_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 517.3;
  camera.fy = 516.5;
  camera.cx = 318.6;
  camera.cy = 255.3;
  return camera;
}

void expect_round_trip(const Camera& camera) {
  for (int y = 5; y < camera.height; y += 47) {
    for (int x = 5; x < camera.width; x += 53) {
      const Eigen::Vector2d raw(x, y);
      EXPECT_LT((camera.distort(camera.undistort(raw)) - raw).norm(), 1e-6) << x << " " << y;
    }
  }
}

TEST(Camera, RadialTangentialDistortionIsInverted) {
  Camera camera = test_camera();
  camera.distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633};  // TUM freiburg1
  expect_round_trip(camera);
}

TEST(Camera, FisheyeDistortionIsInverted) {
  Camera camera = test_camera();
  camera.lens = LensModel::kFisheye;
  camera.distortion = {-0.02, 0.01, -0.005, 0.001, 0.0};
  expect_round_trip(camera);
}

TEST(Camera, ProjectsItsOwnRays) {
  const Camera camera = test_camera();
  const Eigen::Vector2d pixel(123.25, 77.5);
  EXPECT_LT((camera.project(3.0 * camera.ray(pixel)) - pixel).norm(), 1e-12);
}

TEST(Camera, ScalingKeepsTheEdgesOfTheImage) {
  const Camera camera = test_camera();
  const Camera half = camera.scaled_to(320, 240);
  // The left edge of the image is at -0.5 in both.
  const Eigen::Vector3d left = camera.ray({-0.5, -0.5});
  EXPECT_NEAR(half.project(left).x(), -0.5, 1e-12);
  EXPECT_NEAR(half.project(left).y(), -0.5, 1e-12);
}

TEST(Camera, GuessHasSixtyDegreesOverTheLongerSide) {
  const Camera portrait = guess_camera(480, 640);
  EXPECT_TRUE(portrait.guessed);
  EXPECT_NEAR(2.0 * std::atan(320.0 / portrait.fy) * 180.0 / M_PI, 60.0, 1e-9);
  EXPECT_EQ(portrait.fx, portrait.fy);
}

/// Keyframes 0..n-1 one metre apart along x, each with `keypoints` empty slots.
Map map_of_keyframes(int count, std::size_t keypoints) {
  Map map;
  auto features = std::make_shared<Features>();
  features->keypoints.resize(keypoints);
  features->descriptors.resize(keypoints);
  for (int i = 0; i < count; ++i) {
    Keyframe keyframe;
    keyframe.id = i;
    keyframe.parent = i - 1;
    keyframe.features = features;
    keyframe.landmarks.assign(keypoints, kNone);
    keyframe.cam_from_world.translation().x() = -i;
    map.keyframes.put(keyframe);
  }
  return map;
}

LandmarkId put_landmark(Map& map, const Eigen::Vector3d& position) {
  Landmark landmark;
  landmark.id = map.landmarks.next_id();
  landmark.position = position;
  return map.landmarks.put(landmark).id;
}

TEST(Map, ObservationsAreKeptOnBothSides) {
  Map map = map_of_keyframes(3, 4);
  const LandmarkId id = put_landmark(map, {0, 0, 5});
  map.add_observation(id, 2, 1);
  map.add_observation(id, 0, 3);
  map.add_observation(id, 0, 2);  // seen there already: ignored
  ASSERT_EQ(map.landmarks.at(id).observations.size(), 2U);
  EXPECT_EQ(map.landmarks.at(id).observations[0].keyframe, 0);
  EXPECT_EQ(map.keyframes.at(0).landmarks[3], id);
  EXPECT_EQ(map.keyframes.at(0).landmarks[2], kNone);
  map.remove_observation(id, 0);
  EXPECT_FALSE(map.landmarks.contains(id)) << "one observer is too few";
  EXPECT_EQ(map.keyframes.at(2).landmarks[1], kNone);
}

TEST(Map, ReplacedLandmarksAreFoundAgain) {
  Map map = map_of_keyframes(3, 4);
  const LandmarkId a = put_landmark(map, {0, 0, 5});
  const LandmarkId b = put_landmark(map, {0, 0, 5});
  const LandmarkId c = put_landmark(map, {0, 0, 5});
  map.add_observation(a, 0, 0);
  map.add_observation(a, 1, 0);
  map.add_observation(b, 1, 1);
  map.add_observation(b, 2, 1);
  map.add_observation(c, 2, 2);
  map.replace_landmark(a, b);
  map.replace_landmark(b, c);
  EXPECT_EQ(map.resolve(a), c);
  EXPECT_EQ(map.landmarks.size(), 1U);
  EXPECT_EQ(map.landmarks.at(c).observations.size(), 3U);
  EXPECT_EQ(map.keyframes.at(1).landmarks[0], kNone) << "b was seen there already";
  EXPECT_EQ(map.resolve(17), kNone);
}

TEST(Map, ErasedKeyframesKeepAPoseByTheirParent) {
  Map map = map_of_keyframes(4, 1);
  map.erase_keyframe(2);
  EXPECT_EQ(map.keyframes.at(3).parent, 1);
  map.keyframes.at(1).cam_from_world.translation().x() = -10.0;
  EXPECT_NEAR(map.keyframe_pose(2).translation().x(), -11.0, 1e-12);
}

TEST(Map, TransformMovesCamerasPointsAndPlanesTogether) {
  Map map = map_of_keyframes(2, 1);
  const LandmarkId id = put_landmark(map, {1, 2, 5});
  Plane plane;
  plane.id = 0;
  plane.normal = Eigen::Vector3d(0, 0, -1);
  plane.offset = 5.0;
  plane.origin = Eigen::Vector3d(0, 0, 5);
  map.planes.put(plane);
  const Eigen::Vector3d before = map.keyframes.at(1).cam_from_world * map.landmarks.at(id).position;
  Pose turn = Pose::Identity();
  turn.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  turn.translation() = Eigen::Vector3d(3, -1, 2);
  map.transform(2.0, turn);
  const Eigen::Vector3d after = map.keyframes.at(1).cam_from_world * map.landmarks.at(id).position;
  EXPECT_LT((after - 2.0 * before).norm(), 1e-12) << "the camera sees the same, twice as far";
  EXPECT_NEAR(map.planes.at(0).signed_distance(map.landmarks.at(id).position), 0.0, 1e-12);
}

TEST(SlotStore, IteratesInOrderOfIdsAndNeverReusesThem) {
  Map map;
  for (int i = 0; i < 5; ++i) put_landmark(map, Eigen::Vector3d::Zero());
  map.landmarks.erase(0);
  map.landmarks.erase(4);
  std::vector<int> ids;
  for (const Landmark& landmark : map.landmarks) ids.push_back(landmark.id);
  EXPECT_EQ(ids, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(map.landmarks.next_id(), 5);
}

}  // namespace
}  // namespace planecast::slam
