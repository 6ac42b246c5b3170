#include "slam/stages/start_bundle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/geometry/random.h"
#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using synthetic::gaussian3;
using synthetic::noisy;
using synthetic::pose_at;
using synthetic::random_pixel;

constexpr int kCorners = 300;
constexpr int kFrames = 12;
constexpr double kNoisePx = 0.1;

Camera test_camera() {
  Camera camera = guess_camera(640, 480);
  camera.guessed = false;
  return camera;
}

struct World {
  FollowedCorners corners;
  std::vector<double> depths;
  Pose newest_from_ref;
};

/// Corners at depths of 1.5 to 4; the camera ends at `centre`, turned by `turn`, after kFrames.
World followed_world(const Eigen::Vector3d& centre, const Eigen::Vector3d& turn,
                     const std::string& name) {
  Random random(synthetic::seed_of(name));
  const Camera camera = test_camera();
  World world;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < kCorners; ++i) {
    const double depth = 1.5 + 2.5 * random.uniform();
    points.push_back(depth * camera.ray(random_pixel(camera, random)));
    world.depths.push_back(depth);
    world.corners.sigma_px.push_back(0.3);
  }
  for (int f = 0; f <= kFrames; ++f) {
    const double share = static_cast<double>(f) / kFrames;
    // A hand trembles on its way.
    const Pose pose = pose_at(share * centre + (f > 0 ? 0.002 : 0.0) * gaussian3(random),
                              share * turn + (f > 0 ? 0.002 : 0.0) * gaussian3(random));
    std::vector<Eigen::Vector2d> pixels;
    for (const Eigen::Vector3d& point : points) {
      pixels.push_back(noisy(camera.project(pose * point), f > 0 ? kNoisePx : 0.0, random));
    }
    world.corners.pixels.push_back(pixels);
    world.newest_from_ref = pose;
  }
  world.newest_from_ref.translation().normalize();
  return world;
}

/// Median relative error of the depths, after the common scale.
double median_error(const StartBundle& bundle, const std::vector<double>& depths) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (bundle.points_ref[i]) ratios.push_back(bundle.points_ref[i]->z() / depths[i]);
  }
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  const double scale = *middle;
  for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1.0);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

TEST(StartBundle, FindsDepthsFromManyFramesWithLittleParallax) {
  // 2 cm at 2.5 m: half a degree.
  const World world = followed_world({0.02, 0.004, 0.004}, {0.01, -0.02, 0.005},
                                     "StartBundle.FindsDepthsFromManyFramesWithLittleParallax");
  // As two views would find it: a little beside the truth.
  Pose guess = world.newest_from_ref;
  guess.translation() = (guess.translation() + Eigen::Vector3d(0.05, 0.05, -0.05)).normalized();
  const auto bundle = bundle_start(test_camera(), world.corners, guess);
  ASSERT_TRUE(bundle.has_value());
  EXPECT_TRUE(bundle->good);
  EXPECT_LT(bundle->depth_error, 0.03);
  // It knows how good it is: within a factor of three either way.
  const double error = median_error(*bundle, world.depths);
  EXPECT_LT(error, 3.0 * bundle->depth_error);
  EXPECT_GT(error, bundle->depth_error / 10.0);
}

TEST(StartBundle, LessParallaxIsLessCertain) {
  StartBundleOptions lenient;
  lenient.min_share = 0.0;
  lenient.min_points = 3;
  const auto error_with = [&](double way) {
    const World world =
        followed_world({way, 0.0, 0.0}, {0.0, -0.01, 0.0}, "StartBundle.LessParallaxIsLessCertain");
    const auto bundle = bundle_start(test_camera(), world.corners, world.newest_from_ref, lenient);
    return bundle ? bundle->depth_error : 1.0;
  };
  EXPECT_LT(error_with(0.08), 0.6 * error_with(0.03));
  EXPECT_GT(error_with(0.003), 0.03);
}

TEST(StartBundle, ARotationIsNoStart) {
  World world =
      followed_world({0.0, 0.0, 0.0}, {0.02, -0.1, 0.0}, "StartBundle.ARotationIsNoStart");
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    world.newest_from_ref.translation() = direction;
    const auto bundle = bundle_start(test_camera(), world.corners, world.newest_from_ref);
    EXPECT_FALSE(bundle && bundle->good);
  }
}

TEST(StartBundle, AStandingCameraIsNoStart) {
  World world =
      followed_world({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, "StartBundle.AStandingCameraIsNoStart");
  world.newest_from_ref.translation() = Eigen::Vector3d(1, 0, 0);
  const auto bundle = bundle_start(test_camera(), world.corners, world.newest_from_ref);
  EXPECT_FALSE(bundle && bundle->good);
}

TEST(StartBundle, ChoosesTheBestOfSeveralPoses) {
  const World world = followed_world({0.04, 0.004, 0.004}, {0.01, -0.02, 0.005},
                                     "StartBundle.ChoosesTheBestOfSeveralPoses");
  Pose back = world.newest_from_ref;
  back.translation() = -back.translation();
  const auto bundle =
      bundle_best_start(test_camera(), world.corners, {back, world.newest_from_ref, back});
  ASSERT_TRUE(bundle.has_value());
  EXPECT_GT(
      bundle->newest_from_ref.translation().normalized().dot(world.newest_from_ref.translation()),
      0.99);
  EXPECT_FALSE(bundle_best_start(test_camera(), world.corners, {back}).has_value());
  EXPECT_FALSE(bundle_best_start(test_camera(), world.corners, {}).has_value());
}

TEST(StartBundle, NeedsSeveralFrames) {
  World world =
      followed_world({0.2, 0.0, 0.0}, {0.0, -0.05, 0.0}, "StartBundle.NeedsSeveralFrames");
  world.corners.pixels = {world.corners.pixels.front(), world.corners.pixels.back()};
  EXPECT_FALSE(bundle_start(test_camera(), world.corners, world.newest_from_ref).has_value());
}

}  // namespace
}  // namespace planecast::slam
