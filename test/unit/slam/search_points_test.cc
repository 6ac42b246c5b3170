#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "slam/features/corner_tracks.h"
#include "slam/features/pyramid.h"
#include "slam/geometry/lens.h"
#include "slam/stages/initialise.h"
#include "slam/stages/prepare_image.h"
#include "slam/stages/search_points.h"
#include "test/unit/slam/synthetic_views.h"
#include "test/unit/slam/textured_plane.h"

namespace planecast::slam {
namespace {

using synthetic::pose_at;
using synthetic::render_plane;
using synthetic::small_camera;

constexpr double kDepth = 2.0;

ImageFeatures view(ImagePreparer& preparer, const Camera& camera, const Pose& cam_from_world,
                   int index) {
  FrameInput frame;
  frame.index = index;
  frame.image = render_plane(camera, cam_from_world, kDepth);
  ImageFeatures image = preparer.read(frame);
  preparer.extract(image, 500);
  return image;
}

/// Two keyframes at the truth that share every fifth corner of the first as a landmark; the second
/// has keypoints for those alone.
Map two_keyframes(const Camera& camera, const ImageFeatures& first, const ImageFeatures& second,
                  const Pose& moved) {
  Map map;
  map.keyframes.put(make_keyframe(first, Pose::Identity(), map));
  auto known = std::make_shared<Features>();
  std::vector<std::pair<int, Eigen::Vector3d>> shared;
  for (int k = 0; k < first.features->size(); k += 5) {
    const Keypoint& keypoint = first.features->keypoints[static_cast<std::size_t>(k)];
    const Eigen::Vector3d point = kDepth * camera.ray(keypoint.pixel.cast<double>());
    Keypoint seen = keypoint;
    seen.pixel = camera.project(moved * point).cast<float>();
    seen.raw = camera.distort(seen.pixel.cast<double>()).cast<float>();
    known->keypoints.push_back(seen);
    known->descriptors.push_back(first.features->descriptors[static_cast<std::size_t>(k)]);
    shared.emplace_back(k, point);
  }
  known->build_grid(camera.width, camera.height);
  ImageFeatures bare = second;
  bare.features = known;
  Keyframe keyframe = make_keyframe(bare, moved, map);
  keyframe.parent = 0;
  map.keyframes.put(keyframe);
  for (std::size_t i = 0; i < shared.size(); ++i) {
    Landmark landmark;
    landmark.id = map.landmarks.next_id();
    landmark.position = shared[i].second;
    map.landmarks.put(landmark);
    map.add_observation(landmark.id, 0, shared[i].first);
    map.add_observation(landmark.id, 1, static_cast<int>(i));
  }
  return map;
}

void expect_landmarks_on_the_plane(const Camera& camera) {
  PrepareOptions prepare;
  ImagePreparer preparer(prepare, camera);
  constexpr double kBaseline = 0.2;
  const Pose moved = pose_at({kBaseline, 0.02, 0.03}, {0.01, -0.06, 0.02});
  const ImageFeatures first = view(preparer, camera, Pose::Identity(), 0);
  const ImageFeatures second = view(preparer, camera, moved, 1);
  Map map = two_keyframes(camera, first, second, moved);
  const std::size_t before = map.landmarks.size();
  PointMappingStats stats;
  SearchLog log;
  SearchPointsOptions options;
  options.max_points = 400;
  const std::vector<Sighting> sightings = search_points(map, 1, camera, options, log);
  put_sightings(map, 1, camera, second.grey_or_bgr, 0.0, sightings, options, preparer.extractor(),
                stats);

  EXPECT_EQ(map.landmarks.size() - before, static_cast<std::size_t>(stats.triangulated));
  // Of some 400 free corners in the first, those that the second sees too.
  ASSERT_GT(stats.triangulated, 150);
  // A tenth of a pixel in the image: depth^2 / (f * baseline) * 0.1.
  const double tolerance = kDepth * kDepth / (camera.fx * kBaseline) * 0.1;
  std::vector<double> errors;
  for (const Landmark& landmark : map.landmarks) {
    if (landmark.id < static_cast<LandmarkId>(before)) continue;
    EXPECT_EQ(landmark.observations.size(), 2U);
    errors.push_back(std::abs(landmark.position.z() - kDepth));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], tolerance);
  EXPECT_LT(errors[errors.size() * 95 / 100], 5.0 * tolerance);
  const Keyframe& keyframe = map.keyframes.at(1);
  EXPECT_EQ(keyframe.landmarks.size(), keyframe.features->keypoints.size());
  EXPECT_EQ(keyframe.labels.size(), keyframe.features->keypoints.size());
  EXPECT_EQ(keyframe.features->descriptors.size(), keyframe.features->keypoints.size());
}

TEST(SearchPoints, FindsThePlaneWhereOnlyOneImageHasCorners) {
  expect_landmarks_on_the_plane(small_camera());
}

TEST(SearchPoints, WorksThroughADistortedLens) {
  Camera camera = small_camera();
  camera.distortion = {-0.2, 0.05, 0.0, 0.0, 0.0};
  expect_landmarks_on_the_plane(camera);
}

TEST(SearchPoints, LeavesWhatWasLookedForInVainAlone) {
  const Camera camera = small_camera();
  PrepareOptions prepare;
  ImagePreparer preparer(prepare, camera);
  const Pose moved = pose_at({0.2, 0.02, 0.03}, {0.01, -0.06, 0.02});
  const ImageFeatures first = view(preparer, camera, Pose::Identity(), 0);
  const ImageFeatures second = view(preparer, camera, moved, 1);
  const Map map = two_keyframes(camera, first, second, moved);
  SearchPointsOptions options;
  options.max_points = 10000;
  SearchLog log;
  for (int search = 0; search < options.max_searches; ++search) {
    EXPECT_GT(search_points(map, 1, camera, options, log).size(), 150U);
  }
  EXPECT_TRUE(search_points(map, 1, camera, options, log).empty());
}

TEST(CornerTracks, FollowWithoutDrift) {
  const Camera camera = small_camera();
  PrepareOptions prepare;
  ImagePreparer preparer(prepare, camera);
  const ImageFeatures reference = view(preparer, camera, Pose::Identity(), 0);
  CornerTracks tracks{CornerTracksOptions{}};
  tracks.start(*reference.pyramid, *reference.features);
  ASSERT_GT(tracks.started(), 200);
  Pose pose = Pose::Identity();
  for (int i = 1; i <= 12; ++i) {
    pose = pose_at({0.012 * i, 0.01 * std::sin(i), 0.004 * i}, {0.002 * i, 0.0, 0.006 * i});
    tracks.follow(build_pyramid(render_plane(camera, pose, kDepth)));
  }
  // What left the image on the side is lost, the rest is there.
  EXPECT_GT(tracks.tracks().size(), 0.7 * tracks.started());
  double sum = 0.0;
  for (const CornerTrack& track : tracks.tracks()) {
    const Keypoint& keypoint =
        reference.features->keypoints[static_cast<std::size_t>(track.keypoint)];
    const Eigen::Vector3d point = kDepth * camera.ray(keypoint.pixel.cast<double>());
    sum += (project_raw(camera, pose * point) - track.raw.cast<double>()).norm();
  }
  // The roll of 4 degrees, which is not in the template, moves the corners of the patch by 0.4 px;
  // the bias of its place is less than half of that.
  EXPECT_LT(sum / static_cast<double>(tracks.tracks().size()), 0.2);
}

}  // namespace
}  // namespace planecast::slam
