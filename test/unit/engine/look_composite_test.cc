#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "engine/look/grain.h"
#include "engine/look/lens_warp.h"
#include "engine/look/object_layer.h"
#include "engine/scene/patches.h"
#include "table_world.h"

namespace planecast::engine {
namespace {

ObjectLayer uniform_layer(cv::Size size, const cv::Vec4b& rgba, cv::Rect bounds) {
  ObjectLayer layer;
  layer.rgba = cv::Mat::zeros(size, CV_8UC4);
  layer.rgba(bounds).setTo(cv::Scalar(rgba[0], rgba[1], rgba[2], rgba[3]));
  layer.depth = cv::Mat::zeros(size, CV_32FC1);
  layer.depth(bounds).setTo(1.5F);
  layer.bounds = bounds;
  return layer;
}

TEST(Composite, IsExactForEveryAlphaAndValue) {
  // Row a of the layer has alpha a and a colour of half of it; column v of the frame has value v.
  ObjectLayer layer;
  layer.rgba.create(256, 256, CV_8UC4);
  layer.bounds = {0, 0, 256, 256};
  cv::Mat frame(256, 256, CV_8UC3);
  for (int a = 0; a < 256; ++a) {
    for (int v = 0; v < 256; ++v) {
      layer.rgba.at<cv::Vec4b>(a, v) =
          cv::Vec4b(static_cast<uchar>(a / 2), 0, static_cast<uchar>(a), static_cast<uchar>(a));
      frame.at<cv::Vec3b>(a, v) = cv::Vec3b(static_cast<uchar>(v), static_cast<uchar>(v), 0);
    }
  }
  composite(layer, frame);
  for (int a = 0; a < 256; ++a) {
    for (int v = 0; v < 256; ++v) {
      const int kept = static_cast<int>(std::floor((255 - a) * v / 255.0 + 0.5));
      const cv::Vec3b pixel = frame.at<cv::Vec3b>(a, v);
      ASSERT_EQ(pixel[0], std::min(a + kept, 255));  // blue
      ASSERT_EQ(pixel[1], kept);
      ASSERT_EQ(pixel[2], a / 2);  // red
    }
  }
}

TEST(Composite, LeavesThePictureOutsideTheBoundsAlone) {
  cv::Mat frame(40, 60, CV_8UC3);
  cv::randu(frame, 0, 256);
  const cv::Mat before = frame.clone();
  ObjectLayer layer = uniform_layer(frame.size(), {10, 20, 30, 255}, {10, 5, 20, 15});
  layer.rgba.at<cv::Vec4b>(0, 0) = {9, 9, 9, 255};  // outside the bounds: ignored
  composite(layer, frame);
  cv::Mat changed;
  cv::compare(frame.reshape(1), before.reshape(1), changed, cv::CMP_NE);
  changed = changed.reshape(3);
  EXPECT_EQ(frame.at<cv::Vec3b>(6, 11), cv::Vec3b(30, 20, 10));
  changed(layer.bounds).setTo(0);
  EXPECT_EQ(cv::countNonZero(changed.reshape(1)), 0);
}

TEST(LensWarp, DrawsWhereTheCameraSees) {
  slam::Camera camera = table_world().camera;
  camera.distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  const LensWarp warp(camera);
  ASSERT_TRUE(warp.needed());
  const slam::Camera& layer_camera = warp.layer_camera();
  EXPECT_FALSE(layer_camera.has_distortion());
  // Discs drawn at the pinhole's pixels must arrive at the distorted pixels of the same points.
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.45, 0.3, 1.0), Eigen::Vector3d(-0.5, -0.35, 1.0),
        Eigen::Vector3d(0.0, 0.1, 1.0)}) {
    const Eigen::Vector2d drawn = layer_camera.project(point);
    ObjectLayer layer;
    layer.rgba = cv::Mat::zeros(layer_camera.height, layer_camera.width, CV_8UC4);
    layer.depth = cv::Mat::zeros(layer.rgba.size(), CV_32FC1);
    constexpr int kShift = 6;  // sub-pixel positions of cv::circle
    cv::circle(layer.rgba,
               {static_cast<int>(std::lround(drawn.x() * (1 << kShift))),
                static_cast<int>(std::lround(drawn.y() * (1 << kShift)))},
               6 << kShift, cv::Scalar(255, 255, 255, 255), cv::FILLED, cv::LINE_AA, kShift);
    layer.bounds =
        cv::Rect(static_cast<int>(drawn.x()) - 10, static_cast<int>(drawn.y()) - 10, 21, 21) &
        cv::Rect(cv::Point(), layer.rgba.size());
    const ObjectLayer raw = warp.to_raw(layer);
    ASSERT_EQ(raw.rgba.size(), cv::Size(camera.width, camera.height));
    cv::Mat alpha;
    cv::extractChannel(raw.rgba, alpha, 3);
    const cv::Moments moments = cv::moments(alpha(raw.bounds));
    ASSERT_GT(moments.m00, 0.0);
    EXPECT_EQ(cv::countNonZero(alpha), cv::countNonZero(alpha(raw.bounds)));
    const Eigen::Vector2d expected = camera.distort(camera.project(point));
    // A disc of 6 px is slightly deformed: its centroid moves by far less than this.
    EXPECT_NEAR(moments.m10 / moments.m00 + raw.bounds.x, expected.x(), 0.15);
    EXPECT_NEAR(moments.m01 / moments.m00 + raw.bounds.y, expected.y(), 0.15);
  }
}

TEST(LensWarp, DoesNothingWithoutDistortion) {
  const LensWarp warp(table_world().camera);
  EXPECT_FALSE(warp.needed());
  const ObjectLayer layer = uniform_layer({640, 480}, {1, 2, 3, 4}, {5, 5, 9, 9});
  EXPECT_EQ(warp.to_raw(layer).rgba.data, layer.rgba.data);
}

TEST(LensWarp, BringsDepthToTheLayersCamera) {
  slam::Camera camera = table_world().camera;
  camera.distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  const LensWarp warp(camera);
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int x = 0; x < depth.cols; ++x) depth.col(x).setTo(1.0F + 0.001F * static_cast<float>(x));
  const cv::Mat seen = warp.depth_to_layer(depth);
  const Eigen::Vector2d layer_pixel = warp.layer_camera().project({0.3, 0.2, 1.0});
  const Eigen::Vector2d raw_pixel = camera.distort(camera.project({0.3, 0.2, 1.0}));
  // Nearest neighbour in both pictures: at most one pixel's step of 0.001 off.
  EXPECT_NEAR(seen.at<float>(static_cast<int>(std::lround(layer_pixel.y())),
                             static_cast<int>(std::lround(layer_pixel.x()))),
              1.0 + 0.001 * raw_pixel.x(), 0.0015);
}

TEST(Grain, MeasuresTheNoiseOfAPicture) {
  for (const double sigma : {2.0, 5.0}) {
    cv::Mat picture(480, 640, CV_8UC1, cv::Scalar(128));
    cv::Mat noise(picture.size(), CV_16SC1);
    cv::RNG rng(7);
    rng.fill(noise, cv::RNG::NORMAL, 0.0, sigma);
    cv::rectangle(picture, {100, 100, 300, 200}, cv::Scalar(60), cv::FILLED);
    cv::add(picture, noise, picture, cv::noArray(), CV_8U);
    // 77,000 coefficients: the median's own error is below 1 %; rounding adds 1/12 to the variance.
    EXPECT_NEAR(estimate_grain(picture), sigma, 0.06 * sigma);
  }
  EXPECT_LT(estimate_grain(cv::Mat(100, 100, CV_8UC1, cv::Scalar(90))), 0.4);
}

TEST(Grain, StaysOnObjectsAndIsTheSameEveryTime) {
  const Grain grain(3);
  const cv::Rect bounds(20, 10, 200, 150);
  const ObjectLayer clean = uniform_layer({320, 240}, {100, 120, 140, 255}, bounds);
  const auto noisy = [&](int frame) {
    ObjectLayer layer = uniform_layer({320, 240}, {100, 120, 140, 255}, bounds);
    layer.depth(cv::Rect(20, 10, 200, 20)).setTo(0.0F);  // shadow rows
    grain.apply(4.0, frame, layer);
    return layer.rgba;
  };
  const cv::Mat first = noisy(5);
  EXPECT_EQ(cv::norm(first, noisy(5), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(first, noisy(6), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(first(cv::Rect(20, 10, 200, 20)), clean.rgba(cv::Rect(20, 10, 200, 20)),
                     cv::NORM_INF),
            0.0);
  const cv::Rect object(20, 30, 200, 130);
  cv::Mat red;
  cv::extractChannel(first(object), red, 0);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(red, mean, deviation);
  EXPECT_NEAR(mean[0], 100.0, 0.3);  // 4 / sqrt(26,000) is far below
  EXPECT_NEAR(deviation[0], 4.0, 0.3);
}

TEST(Patches, CirclesWidenOutlines) {
  PlaneOutline square;
  square.outer = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_EQ(with_circle(square, {0.5, 0.5}, 0.3).outer.size(), 4U);
  const PlaneOutline wide = with_circle(square, {1.0, 0.5}, 0.3);
  constexpr double kCell = 1.3 / 384;
  EXPECT_TRUE(contains(wide, {1.3 - 4 * kCell, 0.5}));
  EXPECT_FALSE(contains(wide, {1.3 + 4 * kCell, 0.5}));
  EXPECT_TRUE(contains(wide, {0.02, 0.02}));
  EXPECT_FALSE(contains(wide, {1.2, 0.9}));
}

TEST(Patches, OccludersAreSoundPlanesThatCarryNothing) {
  Reconstruction world = table_world();
  ContentItem item;
  item.placed.anchor.plane_id = 1;
  item.longest_side = 0.3;
  Content content;
  content.items = {item};
  EXPECT_EQ(plane_occluders(world, content).size(), 2U);
  plane_by_id(world, 2).inliers = 5;
  EXPECT_EQ(plane_occluders(world, content).size(), 1U);
  plane_by_id(world, 0).rms = 0.5;
  EXPECT_TRUE(plane_occluders(world, content).empty());
}

TEST(Patches, ShadowsFallOnPlanesNearTheContent) {
  const Reconstruction world = table_world();
  ContentItem item;
  item.placed.anchor.plane_id = 0;
  item.longest_side = 0.6;
  Content content;
  const auto caught_by = [&](const Eigen::Vector3d& place) {
    content.items = {item};
    content.items[0].placed.anchor.plane_from_anchor.translation() =
        world.planes[0].world_from_plane().inverse() * place;
    std::vector<int> ids;
    for (const MapPatch& patch : shadow_catchers(world, content)) ids.push_back(patch.plane_id);
    return ids;
  };
  // In the middle of the floor its own plane alone; the table is above it and faces away.
  EXPECT_EQ(caught_by({1.5, 1.3, 1.0}), std::vector<int>{0});
  // A metre before the wall the shadow may reach that too.
  EXPECT_EQ(caught_by({1.5, 1.3, 3.0}), (std::vector<int>{0, 2}));
  // From the table none falls through it onto the floor.
  item.placed.anchor.plane_id = 1;
  content.items = {item};
  EXPECT_EQ(shadow_catchers(world, content).size(), 1U);
}

}  // namespace
}  // namespace planecast::engine
