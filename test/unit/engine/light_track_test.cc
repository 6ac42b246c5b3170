#include <gtest/gtest.h>

#include <cmath>

#include "engine/pipeline/scene_light.h"
#include "engine/user_error.h"
#include "picture_sequence.h"
#include "table_world.h"

namespace planecast::engine {
namespace {

constexpr int kFrames = 120;

/// Grey pictures whose brightness flickers from frame to frame by 10 % and, at frame 60, doubles;
/// the map's points have the first half's colour.
Reconstruction grey_world() {
  Reconstruction world = table_world();
  world.frames.clear();
  for (int i = 0; i < kFrames; ++i) {
    FrameRecord frame;
    frame.index = i;
    frame.timestamp = i / 30.0;
    frame.world_from_cam = frame.causal_world_from_cam = slam::Pose::Identity();
    world.frames.push_back(frame);
  }
  for (int i = 0; i < 400; ++i) {
    MapPoint point;
    point.position = Eigen::Vector3d(0.04 * (i % 20) - 0.4, 0.03 * (i / 20) - 0.3, 2.0);
    point.color_rgb = Eigen::Vector3f::Constant(100.0F);
    world.points.push_back(point);
  }
  return world;
}

PictureSequence flickering(const Reconstruction& world) {
  return {world.camera, 0, kFrames, [&world](int index) {
            const double level = (index < 60 ? 100.0 : 137.0) * (index % 12 == 0 ? 1.05 : 0.95);
            slam::FrameInput frame;
            frame.image =
                cv::Mat(world.camera.height, world.camera.width, CV_8UC3, cv::Scalar::all(level));
            return frame;
          }};
}

std::vector<double> brightness(const LightTrack& track) {
  std::vector<double> values;
  for (int i = 0; i < kFrames; ++i) values.push_back(track.at(i).sun_radiance.y());
  return values;
}

double largest_step(const std::vector<double>& values) {
  double largest = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    largest = std::max(largest, std::abs(std::log(values[i] / values[i - 1])));
  }
  return largest;
}

TEST(LightTrack, FollowsTheExposureWithoutFlicker) {
  const Reconstruction world = grey_world();
  PictureSequence sequence = flickering(world);
  for (const bool causal : {false, true}) {
    LightTrackOptions options;
    options.causal = causal;
    const std::vector<double> values =
        brightness(LightTrack(sequence, world, FixedLight{}, options));
    // sRGB 137 / 100 is about 2 in linear light.
    EXPECT_NEAR(std::log(values[110] / values[20]), std::log(2.0), 0.12) << causal;
    // A tenth in sRGB is a quarter in light; what is left of it, and of the step, is a tenth.
    EXPECT_LT(largest_step(values), 0.1) << causal;
  }
}

TEST(LightTrack, CausalKnowsNothingAhead) {
  const Reconstruction world = grey_world();
  PictureSequence sequence = flickering(world);
  LightTrackOptions options;
  options.causal = true;
  const LightTrack whole(sequence, world, std::nullopt, options);
  PictureSequence first_half(world.camera, 0, 60, [&](int i) { return sequence.read(i); });
  const LightTrack half(first_half, world, std::nullopt, options);
  for (int i = 0; i < 60; ++i) {
    EXPECT_EQ(whole.at(i).sun_radiance, half.at(i).sun_radiance) << i;
    EXPECT_EQ(whole.at(i).sun_direction, half.at(i).sun_direction) << i;
  }
}

TEST(LightTrack, FixedLightStaysWhenExposureIsOff) {
  const Reconstruction world = grey_world();
  PictureSequence sequence = flickering(world);
  LightTrackOptions options;
  options.follow_exposure = false;
  const LightTrack track(sequence, world, FixedLight{}, options);
  EXPECT_EQ(track.at(10).sun_radiance, track.at(100).sun_radiance);
}

TEST(LightTrack, BetweenLightsDirectionsStayUnit) {
  SceneLight a;
  SceneLight b;
  b.sun_direction = Eigen::Vector3d::UnitX();
  const SceneLight half = between(a, b, 0.5);
  EXPECT_NEAR(half.sun_direction.norm(), 1.0, 1e-12);
  EXPECT_NEAR(half.sun_direction.dot(a.sun_direction), half.sun_direction.dot(b.sun_direction),
              1e-12);
}

}  // namespace
}  // namespace planecast::engine
