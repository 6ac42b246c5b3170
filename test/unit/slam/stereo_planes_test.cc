// Planes of a finished monocular map by the depth of pairs of its keyframes.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "planes_mapping_tools.h"
#include "planes_world.h"
#include "slam/features/pyramid.h"
#include "slam/geometry/lens.h"
#include "slam/stages/stereo_planes.h"
#include "test/unit/slam/synthetic_views.h"
#include "test/unit/slam/textured_plane.h"

namespace planecast::slam {
namespace {

using Eigen::Vector3d;
using synthetic::pose_at;
using synthetic::render_plane;
using synthetic::small_camera;

constexpr double kDepth = 2.0;

/// Keyframes side by side before the plane z = kDepth, which has a landmark at every `step` pixels
/// of the first.
Map map_of(const Camera& camera, const std::vector<Vector3d>& centres, int step = 60) {
  Map map;
  std::vector<Vector3d> points;
  for (int y = 20; y < camera.height - 20; y += step) {
    for (int x = 20; x < camera.width - 20; x += step) {
      points.push_back(kDepth * camera.ray(Eigen::Vector2d(x, y)));
    }
  }
  for (const Vector3d& centre : centres) {
    Keyframe keyframe;
    keyframe.id = map.keyframes.next_id();
    keyframe.frame_index = keyframe.id;
    keyframe.cam_from_world = pose_at(centre, {0.02 * keyframe.id, -0.05 * centre.x(), 0.0});
    keyframe.pyramid = std::make_shared<ImagePyramid>(
        build_pyramid(render_plane(camera, keyframe.cam_from_world, kDepth)));
    auto features = std::make_shared<Features>();
    for (const Vector3d& point : points) {
      Keypoint keypoint;
      keypoint.pixel = camera.project(keyframe.cam_from_world * point).cast<float>();
      keypoint.raw = project_raw(camera, keyframe.cam_from_world * point).cast<float>();
      features->keypoints.push_back(keypoint);
      features->descriptors.emplace_back();
    }
    features->build_grid(camera.width, camera.height);
    keyframe.features = features;
    keyframe.landmarks.assign(points.size(), kNone);
    keyframe.labels.assign(points.size(), 0);
    map.keyframes.put(keyframe);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    Landmark landmark;
    landmark.id = map.landmarks.next_id();
    landmark.position = points[i];
    landmark.view_from = -points[i].normalized();
    map.landmarks.put(landmark);
    for (KeyframeId id = 0; id < map.keyframes.next_id(); ++id) {
      map.add_observation(landmark.id, id, static_cast<int>(i));
    }
  }
  return map;
}

const std::vector<Vector3d> kBeside = {
    {0, 0, 0}, {0.36, 0, 0}, {-0.36, 0.02, 0}, {0.1, 0.34, 0}, {0.7, 0, 0}};

PlaneContext context_of(const Camera& camera) {
  PlaneContext context;
  context.camera = camera;
  context.scale = {0.02 * kDepth, 0.01 * kDepth, 0.02 * kDepth};
  context.metre = kDepth / 2.5;
  return context;
}

struct Agreement {
  double known = 0.0;  ///< share of the pixels
  double right = 0.0;  ///< of these, within 1 %
};

Agreement agreement(const cv::Mat& depth, const Map& map, const Camera& camera) {
  const Pose world_from_cam = map.keyframes.at(0).cam_from_world.inverse();
  int known = 0;
  int right = 0;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const double z = depth.at<float>(y, x);
      if (!(z > 0.0)) continue;
      const Vector3d ray = camera.ray(camera.undistort(Eigen::Vector2d(x, y)));
      const double truth =
          (kDepth - world_from_cam.translation().z()) / (world_from_cam.linear() * ray).z();
      ++known;
      right += std::abs(z - truth) < 0.01 * truth;
    }
  }
  return {known / static_cast<double>(depth.total()), right / std::max(1.0, 1.0 * known)};
}

TEST(StereoDepth, IsThatOfTheSurface) {
  Camera bent = small_camera();
  bent.distortion = {-0.12, 0.02, 0.0, 0.0, 0.0};
  for (const Camera& camera : {small_camera(), bent}) {
    const Map map = map_of(camera, kBeside);
    const cv::Mat depth = StereoDepth(camera, {}).of(map, 0);
    ASSERT_EQ(depth.size(), cv::Size(camera.width, camera.height));
    const Agreement found = agreement(depth, map, camera);
    EXPECT_GT(found.known, 0.6);
    EXPECT_GT(found.right, 0.95);
  }
}

TEST(StereoDepth, IsTheSameWithManyThreads) {
  const Camera camera = small_camera();
  const Map map = map_of(camera, kBeside);
  StereoDepthOptions many;
  many.threads = 3;
  const cv::Mat one = StereoDepth(camera, {}).of(map, 0);
  const cv::Mat three = StereoDepth(camera, many).of(map, 0);
  EXPECT_EQ(cv::norm(one, three, cv::NORM_INF), 0.0);
}

TEST(StereoDepth, NeedsTwoKeyframesBeside) {
  const Camera camera = small_camera();
  EXPECT_TRUE(StereoDepth(camera, {}).of(map_of(camera, {kBeside[0], kBeside[1]}), 0).empty());
  // Ahead of it they see the same from the same side.
  const std::vector<Vector3d> ahead = {{0, 0, 0}, {0, 0, 0.3}, {0, 0, 0.6}};
  EXPECT_TRUE(StereoDepth(camera, {}).of(map_of(camera, ahead), 0).empty());
}

TEST(StereoPlanes, FindsAPlaneOfWhichNoLandmarkSpeaks) {
  const Camera camera = small_camera();
  Map map = map_of(camera, kBeside);
  find_stereo_planes(map, context_of(camera), {});
  ASSERT_EQ(map.planes.size(), 1U);
  const Plane& plane = *map.planes.begin();
  EXPECT_FALSE(plane.weak);
  EXPECT_LT(angle_deg(plane.normal, -Vector3d::UnitZ()), 0.3);
  EXPECT_NEAR(plane.signed_distance(Vector3d(0, 0, kDepth)), 0.0, 0.002 * kDepth);
  for (const Keyframe& keyframe : map.keyframes) EXPECT_TRUE(keyframe.depth.empty());
}

/// A strong plane of 40 landmarks of its own.
PlaneId put_plane(const Vector3d& normal, const Vector3d& through, Map& map) {
  Plane plane;
  plane.id = map.planes.next_id();
  plane.refit(normal.normalized(), -normal.normalized().dot(through));
  plane.origin = through;
  plane.weak = false;
  plane.observers = {0, 1, 2, 3};
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = normal.normalized().cross(x);
  for (int i = 0; i < 40; ++i) {
    Landmark landmark;
    landmark.id = map.landmarks.next_id();
    landmark.position = through + 0.08 * (i % 8 - 3.5) * x + 0.08 * (i / 8 - 2) * y;
    landmark.view_from = -landmark.position.normalized();
    landmark.plane = plane.id;
    map.landmarks.put(landmark);
  }
  plane.inliers = 40;
  const PlaneId id = plane.id;
  map.planes.put(std::move(plane));
  return id;
}

TEST(StereoPlanes, ASlabThatTheSurfaceDoesNotFaceBecomesWeak) {
  const Camera camera = small_camera();
  Map map = map_of(camera, kBeside);
  const PlaneId slab = put_plane({0, -1, -1}, {0, 0, kDepth}, map);
  find_stereo_planes(map, context_of(camera), {});
  ASSERT_TRUE(map.planes.contains(slab));
  EXPECT_TRUE(map.planes.at(slab).weak);
}

TEST(StereoPlanes, WhatManyLandmarksHoldKeepsItsEquation) {
  const Camera camera = small_camera();
  Map map = map_of(camera, kBeside, 18);
  const PlaneId known = put_plane({0, 0, -1}, {0, 0, 1.003 * kDepth}, map);
  for (Landmark& landmark : map.landmarks) landmark.plane = known;
  // Of an earlier recording of the place.
  add_depth_point(map.planes.at(known), 0, {0.1, 0.2, kDepth}, {0.1F, 0.2F, 2.0F});
  const Plane before = map.planes.at(known);
  find_stereo_planes(map, context_of(camera), {});
  EXPECT_EQ(map.planes.size(), 1U);
  const Plane& after = map.planes.at(known);
  EXPECT_FALSE(after.weak);
  EXPECT_EQ(after.normal, before.normal);
  EXPECT_EQ(after.offset, before.offset);
  EXPECT_EQ(after.depth_points, before.depth_points);
  EXPECT_EQ(after.inliers, static_cast<int>(map.landmarks.size()));
}

}  // namespace
}  // namespace planecast::slam
