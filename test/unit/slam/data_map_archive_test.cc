#include "slam/data/map_archive.h"

#include <gtest/gtest.h>

#include <cstring>

#include "test/unit/slam/synthetic_map.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

/// A map with all that an archive holds: erased keyframes, replaced landmarks, planes, loop edges.
MapScene full_map() {
  Random random(seed_of("MapArchive"));
  MapOptions options;
  options.keyframes = 7;
  options.points = 60;
  options.depth = true;
  MapScene scene = make_box_map(options, random);
  for (const Landmark& landmark : scene.map.landmarks) {
    scene.map.update_landmark_summary(landmark.id, {});
  }
  scene.map.keyframes.at(4).unit = 1.25;
  scene.map.replace_landmark(3, 8);
  scene.map.erase_landmark(10);
  scene.map.erase_keyframe(5);
  Plane plane;
  plane.id = 2;
  plane.normal = Eigen::Vector3d(0.6, 0.0, 0.8);
  plane.offset = -1.5;
  plane.origin = Eigen::Vector3d(0.9, 0.1, 1.2);
  plane.x_axis = Eigen::Vector3d::UnitY();
  plane.observers = {0, 2};
  plane.merged_from = {1};
  plane.depth_points = {Eigen::Vector3d(1.0, 2.0, 3.0)};
  plane.depth_anchors = {{2, Eigen::Vector3f(0.5F, 0.25F, 2.0F)}};
  scene.map.planes.put(plane);
  scene.map.landmarks.at(8).plane = 2;
  scene.map.loop_edges = {{0, 6}};
  return scene;
}

TEST(MapArchive, KeepsEveryBit) {
  const MapScene scene = full_map();
  const std::string bytes = MapArchive::encode(scene.map);
  const auto back = MapArchive::decode(bytes, scene.camera);
  ASSERT_TRUE(back);
  EXPECT_EQ(MapArchive::encode(*back), bytes);
  EXPECT_EQ(different_bits(scene.map, *back), 0);
  EXPECT_EQ(back->keyframes.next_id(), scene.map.keyframes.next_id());
  EXPECT_EQ(back->resolve(3), 8);
  EXPECT_EQ(back->keyframe_pose(5).matrix(), scene.map.keyframe_pose(5).matrix());
  EXPECT_EQ(back->keyframe_unit(4), 1.25);
  EXPECT_EQ(back->loop_edges, scene.map.loop_edges);
  EXPECT_EQ(back->planes.at(2).depth_anchors.front().keyframe, 2);
  // The grid is there again.
  std::vector<int> found;
  const Keyframe& keyframe = back->keyframes.at(0);
  keyframe.features->find_in_area(keyframe.features->keypoints[0].pixel.cast<double>(), 1.0, 0, 7,
                                  found);
  EXPECT_FALSE(found.empty());
}

TEST(MapArchive, AnEmptyMapIsOne) {
  const auto back = MapArchive::decode(MapArchive::encode(Map()), synthetic::camera());
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->keyframes.empty());
}

TEST(MapArchive, TruncatedBytesAreRefused) {
  const MapScene scene = full_map();
  const std::string bytes = MapArchive::encode(scene.map);
  for (std::size_t length = 0; length < bytes.size(); length += 97) {
    EXPECT_FALSE(MapArchive::decode(std::string_view(bytes).substr(0, length), scene.camera));
  }
  EXPECT_FALSE(MapArchive::decode(bytes + '\0', scene.camera));
}

/// Whatever a byte becomes, the result is a sound map or none.
TEST(MapArchive, NoByteBreaksAnInvariant) {
  const MapScene scene = full_map();
  const std::string bytes = MapArchive::encode(scene.map);
  int refused = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::string broken = bytes;
    broken[i] = static_cast<char>(~broken[i]);
    const auto map = MapArchive::decode(broken, scene.camera);
    if (!map) {
      ++refused;
      continue;
    }
    for (const Landmark& landmark : map->landmarks) {
      for (const Observation& observation : landmark.observations) {
        const Keyframe& keyframe = map->keyframes.at(observation.keyframe);
        ASSERT_EQ(keyframe.landmarks.at(static_cast<std::size_t>(observation.keypoint)),
                  landmark.id);
      }
    }
  }
  EXPECT_GT(refused, 0);
}

/// Ids are places in memory: a short file must not ask for gigabytes of them.
TEST(MapArchive, MoreIdsThanAnyMapHasAreRefused) {
  std::string bytes = MapArchive::encode(Map());
  const std::int32_t ids = 1 << 26;
  std::memcpy(bytes.data(), &ids, sizeof(ids));  // the keyframes' next id comes first
  EXPECT_FALSE(MapArchive::decode(bytes, synthetic::camera()));
}

TEST(MapArchive, HistoriesThatNeverEndAreRefused) {
  MapScene scene = full_map();
  scene.map.keyframes.at(2).parent = 3;
  EXPECT_FALSE(MapArchive::decode(MapArchive::encode(scene.map), scene.camera));
}

}  // namespace
}  // namespace planecast::slam
