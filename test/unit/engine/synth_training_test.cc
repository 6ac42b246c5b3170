#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <set>

#include "engine/sequence/synth/training_picture.h"

namespace planecast::engine::synth {
namespace {

constexpr std::uint64_t kRoom = 424242;

TrainingSample sample(std::uint64_t room_seed, std::uint64_t view) {
  TileBank bank(5, 8);
  const TrainingRoom room = make_training_room(room_seed, bank);
  return TrainingPainter(room, bank, room_seed).draw(view);
}

TEST(TrainingRooms, AreAFunctionOfTheirSeeds) {
  const TrainingSample a = sample(kRoom, 1);
  const TrainingSample b = sample(kRoom, 1);
  EXPECT_EQ(cv::norm(a.bgr, b.bgr, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(a.labels, b.labels, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(a.bgr, sample(kRoom, 2).bgr, cv::NORM_L1), 0.0);
  EXPECT_GT(cv::norm(a.bgr, sample(kRoom + 1, 1).bgr, cv::NORM_L1), 0.0);
}

TEST(TrainingRooms, TruthIsOfOnePieceWithItself) {
  for (std::uint64_t view = 0; view < 6; ++view) {
    const TrainingSample s = sample(kRoom + view, view);
    ASSERT_EQ(s.bgr.size(), cv::Size(kTrainingWidth, kTrainingHeight));
    std::map<int, cv::Vec<schar, 3>> normal_of;
    std::map<int, int> pixels;
    int planar = 0;
    for (int y = 0; y < kTrainingHeight; ++y) {
      for (int x = 0; x < kTrainingWidth; ++x) {
        const int label = s.labels.at<uchar>(y, x);
        const auto& normal = s.normals.at<cv::Vec<schar, 3>>(y, x);
        if (label == 0 || label == kIgnoredLabel) continue;
        ++planar;
        ++pixels[label];
        // One plane has one normal, of length one, and it points to the camera.
        const auto first = normal_of.emplace(label, normal).first->second;
        EXPECT_LE(cv::norm(cv::Vec3i(normal) - cv::Vec3i(first), cv::NORM_INF), 1.0) << label;
        EXPECT_NEAR(cv::norm(cv::Vec3d(normal)), 127.0, 2.0);
      }
    }
    EXPECT_NEAR(s.non_planar, 1.0 - planar / (kTrainingWidth * kTrainingHeight * 1.0), 1e-12);
    for (const auto& [label, count] : pixels) {
      EXPECT_GE(count, TrainingViewOptions{}.min_plane_share * s.labels.total()) << label;
    }
    const cv::Mat asked = asked_labels(s.labels);
    EXPECT_EQ(cv::countNonZero(asked), planar);
  }
}

TEST(TrainingRooms, HoldManyThingsThatAreNotPlanar) {
  TileBank bank(6, 8);
  double non_planar = 0.0;
  std::set<std::size_t> sizes;
  constexpr int kRooms = 12;
  for (std::uint64_t seed = 0; seed < kRooms; ++seed) {
    const TrainingRoom room = make_training_room(seed + 31000, bank);
    ASSERT_EQ(room.materials.size(), room.model.patches.size());
    ASSERT_EQ(room.plane.size(), room.model.patches.size());
    sizes.insert(room.model.patches.size());
    non_planar += TrainingPainter(room, bank, seed).draw(seed).non_planar / kRooms;
  }
  EXPECT_GT(sizes.size(), 9U);  // rooms differ
  EXPECT_GT(non_planar, 0.15);
  EXPECT_LT(non_planar, 0.60);
}

TEST(TrainingRaster, SeesTheNearestOfWhatOverlaps) {
  RoomModel model;
  add_flat(model, {-1, -1, 3}, {2, 0, 0}, {0, 2, 0}, plain(Color::Ones()));
  add_flat(model, {-1, -1, 2}, {1, 0, 0}, {0, 2, 0}, plain(Color::Ones()));
  // Passes through the camera's plane: only its far part is seen.
  add_flat(model, {-5, 0.5, -5}, {10, 0, 0}, {0, 0, 10}, plain(Color::Ones()));
  RasterCamera camera;
  camera.width = camera.height = 64;
  camera.fx = camera.fy = 64;
  camera.cx = camera.cy = 31.5F;
  const auto triangles = triangles_of(model);
  const RasterImage image = rasterise(triangles, camera);
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(64 * y + x); };
  const auto patch = [&](int x, int y) {
    return triangles[static_cast<std::size_t>(image.triangle[at(x, y)])].patch;
  };
  EXPECT_EQ(patch(20, 30), 1);
  EXPECT_NEAR(image.inverse_depth[at(20, 30)], 0.5F, 1e-5F);
  EXPECT_EQ(patch(44, 30), 0);
  EXPECT_NEAR(image.inverse_depth[at(44, 30)], 1.0F / 3.0F, 1e-5F);
  EXPECT_EQ(patch(40, 60), 2);
  // y = 0.5 where (60 - 31.5) / 64 z = 0.5
  EXPECT_NEAR(image.inverse_depth[at(40, 60)], 28.5F / 64.0F / 0.5F, 1e-4F);
}

TEST(TilePyramid, AveragesOverTheFootprint) {
  cv::Mat tile(64, 64, CV_32FC3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      tile.at<cv::Vec3f>(y, x) = x % 2 == 0 ? cv::Vec3f(1, 0, 0) : cv::Vec3f(0, 0, 1);
    }
  }
  const TilePyramid pyramid(tile);
  const Color fine = pyramid.at(10.5F / 64.0F, 0.5F, 0.0F);
  EXPECT_NEAR((fine - Color(1, 0, 0)).norm(), 0.0F, 1e-5F);
  const Color coarse = pyramid.at(10.5F / 64.0F, 0.5F, 0.25F);
  EXPECT_NEAR((coarse - Color(0.5F, 0, 0.5F)).norm(), 0.0F, 1e-5F);
  // Repeats are mirrored.
  const Color mirrored = pyramid.at(2.0F - 10.5F / 64.0F, 0.5F, 0.0F);
  EXPECT_NEAR((mirrored - fine).norm(), 0.0F, 1e-4F);
}

}  // namespace
}  // namespace planecast::engine::synth
