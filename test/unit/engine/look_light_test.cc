#include "engine/look/light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "engine/look/camera_blur.h"
#include "engine/look/exposure.h"
#include "engine/pipeline/scene_light.h"
#include "table_world.h"

namespace planecast::engine {
namespace {

const Eigen::Vector3d kUp = -Eigen::Vector3d::UnitY();

/// What the light does to a white surface that faces `normal`.
Eigen::Vector3d on_surface(const SceneLight& light, const Eigen::Vector3d& normal) {
  const double sun = std::max(0.0, light.sun_direction.dot(normal));
  return light.mean * (1.0 + 2.0 / 3.0 * light.gradient.dot(normal)) + sun * light.sun_radiance;
}

SceneLight estimate_from(const cv::Mat& image) {
  LightEstimator estimator;
  estimator.add(image, table_world().camera, slam::Pose::Identity());
  return estimator.estimate(kUp);
}

TEST(Light, UniformPictureGivesItsBrightnessOverTheAlbedos) {
  const cv::Mat grey(480, 640, CV_8UC3, cv::Scalar(128, 128, 128));
  const SceneLight light = estimate_from(grey);
  const Eigen::Vector3d facing_up = on_surface(light, kUp);
  const LightOptions options;
  const double expected =
      srgb_to_linear(128) * 0.5 * (1.0 / options.mean_albedo + 1.0 / options.bright_albedo);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(facing_up[channel], expected, 0.05 * expected);
  // Light comes from above, to the upper left by custom.
  EXPECT_GT(light.sun_direction.dot(kUp), 0.7);
  EXPECT_LT(light.sun_direction.x(), 0.0);
  EXPECT_GT(light.gradient.dot(kUp), 0.0);
  EXPECT_NEAR(light.sun_direction.norm(), 1.0, 1e-9);
}

TEST(Light, FollowsBrightnessAndHalfTheTint) {
  const SceneLight dark = estimate_from(cv::Mat(480, 640, CV_8UC3, cv::Scalar(60, 60, 60)));
  const SceneLight bright = estimate_from(cv::Mat(480, 640, CV_8UC3, cv::Scalar(160, 160, 160)));
  EXPECT_GT(on_surface(bright, kUp).x(), 2.0 * on_surface(dark, kUp).x());
  const SceneLight warm =
      estimate_from(cv::Mat(480, 640, CV_8UC3, cv::Scalar(90, 120, 150)));  // BGR
  EXPECT_GT(warm.mean.x(), 1.05 * warm.mean.z());
  const double scene_ratio = srgb_to_linear(150) / srgb_to_linear(90);
  EXPECT_LT(warm.mean.x() / warm.mean.z(), scene_ratio);
}

TEST(Light, BrightSideIsWhereTheLightComesFrom) {
  cv::Mat image(480, 640, CV_8UC3);
  for (int x = 0; x < image.cols; ++x) image.col(x).setTo(cv::Scalar::all(60 + x * 140 / 640));
  EXPECT_GT(estimate_from(image).sun_direction.x(), 0.15);
  cv::flip(image, image, 1);
  EXPECT_LT(estimate_from(image).sun_direction.x(), -0.15);
}

TEST(Light, LampsInViewDoNotBlind) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar(100, 100, 100));
  const double without = on_surface(estimate_from(image), kUp).x();
  cv::circle(image, {500, 60}, 35, cv::Scalar(255, 255, 255), cv::FILLED);  // 1.3 % of the picture
  EXPECT_NEAR(on_surface(estimate_from(image), kUp).x(), without, 0.05 * without);
}

TEST(Light, AWindowInViewIsWhereTheLightComesFrom) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
  cv::rectangle(image, {440, 20, 150, 140}, cv::Scalar(250, 250, 250), cv::FILLED);
  const SceneLight light = estimate_from(image);
  EXPECT_GT(light.sun_direction.z(), 0.1);  // ahead of the camera
  EXPECT_GT(light.sun_direction.x(), 0.1);  // to its right
  EXPECT_GT(light.sun_direction.dot(kUp), 0.7);
}

TEST(Light, AWindowInViewThrowsDarkerAndLongerShadows) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
  const SceneLight without = estimate_from(image);
  cv::rectangle(image, {440, 20, 150, 140}, cv::Scalar(250, 250, 250), cv::FILLED);
  const SceneLight with = estimate_from(image);
  const auto sun_share = [](const SceneLight& light) {
    const double sun = light.sun_radiance.y() * light.sun_direction.dot(kUp);
    return sun / on_surface(light, kUp).y();
  };
  EXPECT_GT(sun_share(with), sun_share(without) + 0.2);
  EXPECT_LT(with.sun_direction.dot(kUp), without.sun_direction.dot(kUp) - 0.05);
}

TEST(Light, WithoutPicturesStillShines) {
  const SceneLight light = LightEstimator().estimate(kUp);
  EXPECT_GT(on_surface(light, kUp).minCoeff(), 0.2);
  EXPECT_TRUE(light.ambient_sh()[0].allFinite());
}

TEST(Light, HarmonicsReproduceTheSurroundings) {
  SceneLight light;
  light.mean = {0.4, 0.5, 0.6};
  light.gradient = {0.1, -0.2, 0.3};
  const auto sh = light.ambient_sh(2.0);
  const Eigen::Vector3d d = Eigen::Vector3d(1, 2, -2) / 3.0;
  const Eigen::Vector3d radiance =
      0.28209479 * sh[0] + 0.48860251 * (d.y() * sh[1] + d.z() * sh[2] + d.x() * sh[3]);
  EXPECT_LT((radiance - 2.0 * light.mean * (1.0 + light.gradient.dot(d))).norm(), 1e-6);
}

TEST(Light, FixedSunStandsInAFrameWithYUp) {
  FixedLight fixed;
  fixed.sun_direction = {0, 1, 0};
  EXPECT_LT((fixed_light(fixed, kUp).sun_direction - kUp).norm(), 1e-9);
  fixed.sun_direction = {0, 0, 1};  // from behind the viewer, who looks along +z of the world
  EXPECT_LT((fixed_light(fixed, kUp).sun_direction + Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(Blur, MeasuresEachDirection) {
  cv::Mat scene(480, 640, CV_8UC1, cv::Scalar(60));
  cv::RNG rng(11);
  for (int i = 0; i < 60; ++i) {
    cv::rectangle(
        scene, {rng.uniform(0, 600), rng.uniform(0, 440), rng.uniform(20, 80), rng.uniform(20, 80)},
        cv::Scalar(rng.uniform(20, 235)), cv::FILLED);
  }
  const CameraBlur sharp = estimate_blur(scene);
  EXPECT_LT(sharp.sigma_x_px, kVisibleBlur);
  EXPECT_LT(sharp.sigma_y_px, kVisibleBlur);
  for (const double sigma : {1.0, 1.8}) {
    cv::Mat moved;
    cv::GaussianBlur(scene, moved, cv::Size(15, 1), sigma, 0.1);
    const CameraBlur blur = estimate_blur(moved);
    // Quantile of edges next to other edges and 8-bit rounding: a fifth is what the eye cannot
    // tell.
    EXPECT_NEAR(blur.sigma_x_px, sigma, 0.2 * sigma + 0.1);
    EXPECT_LT(blur.sigma_y_px, 0.5);
  }
  EXPECT_EQ(estimate_blur(cv::Mat(480, 640, CV_8UC1, cv::Scalar(90))).sigma_x_px, 0.0);
}

TEST(Blur, KeepsTheLayerPremultipliedAndGrowsItsBounds) {
  ObjectLayer layer;
  layer.rgba = cv::Mat::zeros(100, 100, CV_8UC4);
  layer.rgba(cv::Rect(40, 40, 20, 20)).setTo(cv::Scalar(200, 100, 50, 255));
  layer.bounds = {40, 40, 20, 20};
  apply_blur({2.0, 0.0}, layer);
  EXPECT_EQ(layer.bounds, cv::Rect(34, 40, 32, 20));
  EXPECT_GT(layer.rgba.at<cv::Vec4b>(50, 38)[3], 0);
  EXPECT_EQ(layer.rgba.at<cv::Vec4b>(38, 50)[3], 0);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const cv::Vec4b pixel = layer.rgba.at<cv::Vec4b>(y, x);
      ASSERT_LE(std::max({pixel[0], pixel[1], pixel[2]}), pixel[3]);
    }
  }
}

TEST(Exposure, FollowsTheFrameNotItsContent) {
  Reconstruction world = table_world();
  cv::RNG rng(5);
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar(10, 10, 10));
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector2d pixel(rng.uniform(5, 635), rng.uniform(5, 475));
    const double linear = rng.uniform(0.05, 0.4);
    const auto byte = [](double v) {
      return std::round(255.0 * (1.055 * std::pow(v, 1.0 / 2.4) - 0.055));
    };
    MapPoint point;
    point.position = 2.0 * world.camera.ray(pixel);
    point.color_rgb.setConstant(static_cast<float>(byte(linear)));
    world.points.push_back(point);
    cv::circle(image, {static_cast<int>(pixel.x()), static_cast<int>(pixel.y())}, 2,
               cv::Scalar::all(byte(1.5 * linear)), cv::FILLED);
  }
  // Some discs overlap: outliers. Two per cent is a few steps of 8-bit rounding.
  EXPECT_NEAR(exposure_gain(world, image, slam::Pose::Identity()), 1.5, 0.03);
  world.points.resize(20);
  EXPECT_EQ(exposure_gain(world, image, slam::Pose::Identity()), 1.0);
}

}  // namespace
}  // namespace planecast::engine
