#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "slam/features/patch.h"
#include "slam/features/pyramid.h"
#include "slam/geometry/lens.h"
#include "slam/stages/align_frame.h"
#include "slam/stages/match_patches.h"
#include "slam/stages/refine_sights.h"
#include "test/unit/slam/synthetic_views.h"
#include "test/unit/slam/textured_plane.h"

namespace planecast::slam {
namespace {

using synthetic::pose_at;
using synthetic::render_plane;

constexpr double kDepth = 2.0;
/// Where the steps end (0.02 px), and as much again for bilinear interpolation of waves 11 px long.
/// 8-bit rounding (sigma 0.29 over the root of a patch's summed squared gradients, over 200) is
/// nothing beside it.
constexpr double kPatchTolerancePx = 0.04;

Camera test_camera() {
  Camera camera = guess_camera(320, 240);
  camera.guessed = false;
  return camera;
}

/// Raw pixel of a point of the plane, and back.
Eigen::Vector2d seen_at(const Camera& camera, const Pose& cam_from_world, double x, double y) {
  return project_raw(camera, cam_from_world * Eigen::Vector3d(x, y, kDepth));
}

TEST(Pyramid, KeepsPlacesOverItsLevels) {
  const Camera camera = test_camera();
  const ImagePyramid pyramid = build_pyramid(render_plane(camera, Pose::Identity(), kDepth));
  ASSERT_GE(pyramid.levels.size(), 4U);
  EXPECT_EQ(pyramid.levels[2].size(), cv::Size(80, 60));
  const Eigen::Vector2f pixel(101.25F, 77.5F);
  EXPECT_LT((from_level(at_level(pixel, 3), 3) - pixel).norm(), 1e-4F);
  // The mean over 2 x 2 pixels lies at the middle between them.
  EXPECT_FLOAT_EQ(at_level({0.5F, 0.5F}, 1).x(), 0.0F);
}

TEST(Pyramid, LeavesOutTheLastColumnOfAnOddImage) {
  const cv::Mat odd(61, 99, CV_8UC1, cv::Scalar(7));
  const ImagePyramid pyramid = build_pyramid(odd);
  EXPECT_EQ(pyramid.levels[1].size(), cv::Size(49, 30));
}

TEST(Patch, FindsAShiftedPatchToAFractionOfAPixel) {
  const Camera camera = test_camera();
  const cv::Mat before = render_plane(camera, Pose::Identity(), kDepth);
  const Pose moved = pose_at({0.0113, -0.0087, 0.0}, Eigen::Vector3d::Zero());
  const cv::Mat after = render_plane(camera, moved, kDepth);
  int found = 0;
  double sum = 0.0;
  for (double y = -0.4; y < 0.5; y += 0.1) {
    for (double x = -0.6; x < 0.7; x += 0.1) {
      const auto patch =
          make_template(before, seen_at(camera, Pose::Identity(), x, y).cast<float>(),
                        Eigen::Matrix2f::Identity());
      if (!patch) continue;
      const Eigen::Vector2d truth = seen_at(camera, moved, x, y);
      const auto alignment =
          align_patch(*patch, after, truth.cast<float>() + Eigen::Vector2f(1, -1));
      if (!alignment) continue;
      const double error = (alignment->pixel.cast<double>() - truth).norm();
      EXPECT_LT(error, 3.0 * kPatchTolerancePx);
      sum += error;
      EXPECT_GT(alignment->correlation, 0.99F);
      ++found;
    }
  }
  ASSERT_GT(found, 60);
  EXPECT_LT(sum / found, kPatchTolerancePx);
}

TEST(Patch, DoesNotMindExposure) {
  const Camera camera = test_camera();
  const cv::Mat before = render_plane(camera, Pose::Identity(), kDepth);
  const cv::Mat darker = render_plane(camera, Pose::Identity(), kDepth, 0.5, 10.0);
  const Eigen::Vector2f centre = seen_at(camera, Pose::Identity(), 0.1, 0.1).cast<float>();
  const auto patch = make_template(before, centre, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(patch);
  const auto alignment = align_patch(*patch, darker, centre + Eigen::Vector2f(0.7F, 0.6F));
  ASSERT_TRUE(alignment);
  EXPECT_LT((alignment->pixel - centre).norm(), kPatchTolerancePx);
}

TEST(Patch, RefusesWhatHasNoTexture) {
  const cv::Mat flat(60, 60, CV_8UC1, cv::Scalar(90));
  EXPECT_FALSE(make_template(flat, {30.0F, 30.0F}, Eigen::Matrix2f::Identity()));
  cv::Mat edge = flat.clone();
  edge.colRange(30, 60).setTo(160);
  EXPECT_FALSE(make_template(edge, {30.0F, 30.0F}, Eigen::Matrix2f::Identity()))
      << "an edge fixes one coordinate only";
  EXPECT_FALSE(make_template(edge, {2.0F, 30.0F}, Eigen::Matrix2f::Identity()));
}

TEST(Patch, AQuickLookKnowsItsPlace) {
  const Camera camera = test_camera();
  const cv::Mat image = render_plane(camera, Pose::Identity(), kDepth);
  // Between pixels, where the patch has its samples on whole ones.
  const Eigen::Vector2f centre(100.5F, 80.5F);
  const auto samples = sample_patch(image, centre, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(samples);
  const QuickTemplate quick(*samples);
  EXPECT_GT(quick.correlate(image, centre), 0.999F);
  EXPECT_LT(quick.correlate(image, centre + Eigen::Vector2f(4.0F, 0.0F)), 0.8F);
  const cv::Mat negative = 255 - image;
  EXPECT_LT(quick.correlate(negative, centre), -0.999F);
  EXPECT_EQ(quick.correlate(image, {2.0F, 80.5F}), -1.0F) << "beyond the image";
  const cv::Mat flat(image.size(), CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(quick.correlate(flat, centre), -1.0F);
  const auto nothing = sample_patch(flat, centre, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(nothing);
  EXPECT_EQ(QuickTemplate(*nothing).correlate(image, centre), -1.0F);
}

TEST(AlignFrame, FindsThePoseOfALargeMove) {
  const Camera camera = test_camera();
  const cv::Mat before = render_plane(camera, Pose::Identity(), kDepth);
  // About 12 px sideways and 2 degrees of roll at once, and a change of exposure.
  const Pose moved = pose_at({0.08, 0.03, 0.05}, {0.01, -0.01, 0.035});
  const cv::Mat after = render_plane(camera, moved, kDepth, 0.8, 12.0);
  std::vector<Eigen::Vector3d> points;
  for (double y = -0.7; y < 0.8; y += 0.1) {
    for (double x = -0.9; x < 1.0; x += 0.1) points.emplace_back(x, y, kDepth);
  }
  const auto aligned =
      align_frame(camera, build_pyramid(before), points, build_pyramid(after), Pose::Identity());
  ASSERT_TRUE(aligned);
  double sum = 0.0;
  for (const Eigen::Vector3d& point : points) {
    sum += (camera.project(*aligned * point) - camera.project(moved * point)).norm();
  }
  // A quarter of a pixel of the finest level used, which is half of the image's.
  EXPECT_LT(sum / static_cast<double>(points.size()), 0.5);
}

TEST(AlignFrame, RefusesTooFewPoints) {
  const Camera camera = test_camera();
  const ImagePyramid pyramid = build_pyramid(render_plane(camera, Pose::Identity(), kDepth));
  EXPECT_FALSE(align_frame(camera, pyramid, {{0.0, 0.0, kDepth}}, pyramid, Pose::Identity()));
}

/// One keyframe at the origin that sees a grid of landmarks on the plane.
Map map_of_plane(const Camera& camera, const cv::Mat& image) {
  Map map;
  Keyframe keyframe;
  keyframe.id = 0;
  keyframe.pyramid = std::make_shared<const ImagePyramid>(build_pyramid(image));
  auto features = std::make_shared<Features>();
  std::vector<Eigen::Vector3d> points;
  for (double y = -0.6; y < 0.7; y += 0.08) {
    for (double x = -0.8; x < 0.9; x += 0.08) {
      const Eigen::Vector2d raw = seen_at(camera, Pose::Identity(), x, y);
      if (!camera.contains(raw, 8.0)) continue;
      Keypoint keypoint;
      keypoint.raw = raw.cast<float>();
      keypoint.pixel = camera.undistort(raw).cast<float>();
      features->keypoints.push_back(keypoint);
      features->descriptors.push_back({});
      points.emplace_back(x, y, kDepth);
    }
  }
  keyframe.landmarks.assign(points.size(), kNone);
  keyframe.labels.assign(points.size(), 0);
  keyframe.features = features;
  map.keyframes.put(keyframe);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Landmark landmark;
    landmark.id = static_cast<LandmarkId>(i);
    landmark.position = points[i];
    landmark.view_from = -points[i].normalized();
    map.landmarks.put(landmark);
    map.add_observation(landmark.id, 0, static_cast<int>(i));
  }
  return map;
}

void expect_precise_matches(const Camera& camera) {
  const Map map = map_of_plane(camera, render_plane(camera, Pose::Identity(), kDepth));
  // 15 degrees round the plane, 20 % nearer, rolled by 10 degrees.
  const Pose moved = pose_at({0.5, 0.1, 0.35}, {0.03, -0.26, 0.17});
  const ImagePyramid image = build_pyramid(render_plane(camera, moved, kDepth));
  const Pose guess = pose_at({0.003, -0.002, 0.0}, {0.001, 0.002, 0.0}) * moved;
  std::vector<LandmarkId> candidates;
  for (const Landmark& landmark : map.landmarks) candidates.push_back(landmark.id);
  PatchMatchOptions options;
  const PatchMatches found = match_patches(map, camera, image, guess, candidates, options);
  ASSERT_GT(found.matches.size(), 40U);
  EXPECT_GT(found.matches.size(), found.tried.size() / 2);
  double sum = 0.0;
  for (const PatchMatch& match : found.matches) {
    const Eigen::Vector2d truth =
        project_raw(camera, moved * map.landmarks.at(match.landmark).position);
    sum += (match.raw.cast<double>() - truth).norm();
  }
  // Beside the tolerance of a patch: the patch is taken to face the keyframe's optical axis, which
  // is true here, and its perspective to be affine, whose error over 4 px stays under 0.03 px.
  EXPECT_LT(sum / static_cast<double>(found.matches.size()), kPatchTolerancePx + 0.03);
}

TEST(MatchPatches, FindsLandmarksFromAnotherView) { expect_precise_matches(test_camera()); }

TEST(MatchPatches, WorksInRawPixelsOfADistortedLens) {
  Camera camera = test_camera();
  camera.distortion = {-0.25, 0.08, 0.001, -0.0005, 0.0};
  expect_precise_matches(camera);
}

/// Sees all landmarks of a map_of_plane(), each keypoint `off` by as much, to either side in turn.
void add_view(Map& map, const Camera& camera, const Pose& cam_from_world,
              const Eigen::Vector2f& off) {
  Keyframe keyframe;
  keyframe.id = map.keyframes.next_id();
  keyframe.cam_from_world = cam_from_world;
  keyframe.pyramid = std::make_shared<const ImagePyramid>(
      build_pyramid(render_plane(camera, cam_from_world, kDepth)));
  auto features = std::make_shared<Features>(*map.keyframes.at(0).features);
  for (const Landmark& landmark : map.landmarks) {
    Keypoint& keypoint = features->keypoints[static_cast<std::size_t>(landmark.id)];
    const Eigen::Vector2d raw = project_raw(camera, cam_from_world * landmark.position);
    keypoint.raw = raw.cast<float>() + (landmark.id % 2 == 0 ? off : Eigen::Vector2f(-off));
    keypoint.pixel = camera.undistort(keypoint.raw.cast<double>()).cast<float>();
  }
  keyframe.landmarks.assign(features->keypoints.size(), kNone);
  keyframe.labels.assign(features->keypoints.size(), 0);
  keyframe.features = features;
  const KeyframeId id = keyframe.id;
  map.keyframes.put(std::move(keyframe));
  for (LandmarkId landmark = 0; landmark < map.landmarks.next_id(); ++landmark) {
    map.add_observation(landmark, id, landmark);
  }
}

/// Of the keyframe's sights; add_view gives landmark i keypoint i.
double mean_error_px(const Map& map, const Camera& camera, KeyframeId id) {
  const Keyframe& keyframe = map.keyframes.at(id);
  double sum = 0.0;
  int count = 0;
  for (const Landmark& landmark : map.landmarks) {
    const auto k = static_cast<std::size_t>(landmark.id);
    if (keyframe.landmarks[k] == kNone) continue;
    const Eigen::Vector2d truth = project_raw(camera, keyframe.cam_from_world * landmark.position);
    sum += (keyframe.features->keypoints[k].raw.cast<double>() - truth).norm();
    ++count;
  }
  return sum / count;
}

TEST(RefineSights, PutsEachSightWhereTheMiddleOneIs) {
  Camera camera = test_camera();
  camera.distortion = {-0.1, 0.02, 0.0, 0.0, 0.0};
  Map map = map_of_plane(camera, render_plane(camera, Pose::Identity(), kDepth));
  add_view(map, camera, pose_at({-0.08, 0.02, 0.03}, {0.0, 0.03, 0.02}), {0.7F, -0.4F});
  add_view(map, camera, pose_at({0.08, -0.02, 0.02}, {0.01, -0.03, 0.0}), {-0.5F, 0.6F});
  const std::shared_ptr<const Features> before = map.keyframes.at(1).features;
  const RefineSightsResult result = refine_sights(map, camera, {});
  EXPECT_GT(result.refined, 9 * result.removed) << "those near the rim";
  for (const KeyframeId id : {1, 2}) {
    EXPECT_LT(mean_error_px(map, camera, id), 2.0 * kPatchTolerancePx);
    const Keypoint& keypoint = map.keyframes.at(id).features->keypoints[40];
    EXPECT_LT(
        (camera.undistort(keypoint.raw.cast<double>()) - keypoint.pixel.cast<double>()).norm(),
        1e-3);
  }
  EXPECT_LT(mean_error_px(map, camera, 0), 1e-4) << "the reference stays";
  EXPECT_NE(map.keyframes.at(1).features, before) << "other copies of the map keep theirs";
}

TEST(RefineSights, RemovesWhatLooksLikeNoOther) {
  const Camera camera = test_camera();
  Map map = map_of_plane(camera, render_plane(camera, Pose::Identity(), kDepth));
  add_view(map, camera, pose_at({-0.08, 0.02, 0.03}, {0.0, 0.03, 0.02}), {0.7F, -0.4F});
  add_view(map, camera, pose_at({0.08, -0.02, 0.02}, {0.01, -0.03, 0.0}), {-0.5F, 0.6F});
  const auto landmarks = static_cast<int>(map.landmarks.size());
  constexpr LandmarkId kWrong = 40;
  auto features = std::make_shared<Features>(*map.keyframes.at(1).features);
  Keypoint& keypoint = features->keypoints[static_cast<std::size_t>(kWrong)];
  keypoint.raw += Eigen::Vector2f(25.0F, 15.0F);
  keypoint.pixel = camera.undistort(keypoint.raw.cast<double>()).cast<float>();
  map.keyframes.at(1).features = features;
  const RefineSightsResult result = refine_sights(map, camera, {});
  EXPECT_EQ(map.keyframes.at(1).landmarks[static_cast<std::size_t>(kWrong)], kNone);
  EXPECT_EQ(map.landmarks.at(kWrong).observations.size(), 2U);
  EXPECT_EQ(result.refined + result.removed, 2 * landmarks);
}

TEST(RefineSights, NeedsImages) {
  const Camera camera = test_camera();
  Map map = map_of_plane(camera, render_plane(camera, Pose::Identity(), kDepth));
  add_view(map, camera, pose_at({-0.08, 0.02, 0.03}, {0.0, 0.03, 0.02}), {0.7F, -0.4F});
  map.keyframes.at(1).pyramid = nullptr;
  const double error = mean_error_px(map, camera, 1);
  refine_sights(map, camera, {});
  EXPECT_EQ(mean_error_px(map, camera, 1), error);
}

}  // namespace
}  // namespace planecast::slam
