#include "slam/optimize/bundle.h"

#include <gtest/gtest.h>

#include "slam/optimize/bundle_problem.h"
#include "test/unit/slam/synthetic_map.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

double worst_rotation_deg(const MapScene& scene) {
  double worst = 0.0;
  for (const Keyframe& keyframe : scene.map.keyframes) {
    worst = std::max(worst, rotation_error_deg(
                                keyframe.cam_from_world,
                                scene.truth.cam_from_world[static_cast<std::size_t>(keyframe.id)]));
  }
  return worst;
}

double worst_centre(const MapScene& scene, double scale = 1.0) {
  double worst = 0.0;
  for (const Keyframe& keyframe : scene.map.keyframes) {
    const Pose& truth = scene.truth.cam_from_world[static_cast<std::size_t>(keyframe.id)];
    worst =
        std::max(worst, (scale * keyframe.centre_world() - truth.inverse().translation()).norm());
  }
  return worst;
}

double median_point_error(const MapScene& scene, double scale = 1.0) {
  std::vector<double> errors;
  for (const Landmark& landmark : scene.map.landmarks) {
    errors.push_back(
        (scale * landmark.position - scene.truth.points[static_cast<std::size_t>(landmark.id)])
            .norm());
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  return errors[errors.size() / 2];
}

/// Truth over estimate, from the distance of the first two keyframes: what a monocular map leaves
/// open.
double scale_to_truth(const MapScene& scene) {
  return scene.truth.cam_from_world[1].inverse().translation().norm() /
         scene.map.keyframes.at(1).centre_world().norm();
}

TEST(GlobalBundle, ConvergesToTheTruthFromAPerturbedStart) {
  Random random(seed_of("GlobalBundle.ConvergesToTheTruthFromAPerturbedStart"));
  for (const bool depth : {false, true}) {
    MapOptions options;
    options.depth = depth;
    MapScene scene = make_box_map(options, random);
    perturb(scene.map, 1, 0.01, 0.03, 0.05, random);
    BundleOptions bundle;
    bundle.iterations = 20;
    const BundleResult result = global_bundle(scene.map, scene.camera, bundle);
    EXPECT_GT(result.rms_before_px, 3.0);
    // Pixels are floats of up to 640: 3e-5 px.
    EXPECT_LT(result.rms_after_px, 1e-3);
    EXPECT_EQ(result.removed_observations, 0);
    EXPECT_EQ(result.fixed_keyframes, 1);
    EXPECT_EQ(result.free_keyframes, 5);
    EXPECT_EQ(result.focal_factor, 1.0);
    const double scale = depth ? 1.0 : scale_to_truth(scene);
    EXPECT_LT(worst_rotation_deg(scene), 1e-3);
    EXPECT_LT(worst_centre(scene, scale), 1e-4);
    EXPECT_LT(median_point_error(scene, scale), 1e-4);
  }
}

TEST(GlobalBundle, KeepsTheFirstKeyframeAndTheScaleOfAMonocularMap) {
  Random random(seed_of("GlobalBundle.KeepsTheFirstKeyframeAndTheScaleOfAMonocularMap"));
  MapOptions options;
  options.noise_px = 0.5;
  MapScene scene = make_box_map(options, random);
  perturb(scene.map, 1, 0.01, 0.03, 0.05, random);
  const Pose first = scene.map.keyframes.at(0).cam_from_world;
  const double baseline = scene.map.keyframes.at(1).centre_world().norm();
  global_bundle(scene.map, scene.camera, {});
  EXPECT_EQ(scene.map.keyframes.at(0).cam_from_world.matrix(), first.matrix());
  EXPECT_NEAR(scene.map.keyframes.at(1).centre_world().norm(), baseline, 1e-9);
}

TEST(GlobalBundle, TakesOutliersOutOfTheMap) {
  Random random(seed_of("GlobalBundle.TakesOutliersOutOfTheMap"));
  for (const bool depth : {false, true}) {
    MapOptions options;
    options.noise_px = 0.5;
    options.outlier_share = 0.05;
    options.depth = depth;
    MapScene scene = make_box_map(options, random);
    perturb(scene.map, 1, 0.005, 0.01, 0.02, random);
    const BundleResult result = global_bundle(scene.map, scene.camera, {});
    // The gate is at 4.9 sigma of the noise used here: what goes is outliers, and the good partner
    // of an outlier where a landmark has no more observers.
    EXPECT_GE(result.removed_observations, static_cast<int>(0.9 * scene.outliers));
    EXPECT_LE(result.removed_observations, static_cast<int>(1.3 * scene.outliers));
    EXPECT_LT(result.rms_after_px, 1.0);
    const double scale = depth ? 1.0 : scale_to_truth(scene);
    // What the noise alone does: the worst of 30 maps without outliers was at 0.4 degrees, 0.03
    // units.
    EXPECT_LT(worst_rotation_deg(scene), 0.4);
    EXPECT_LT(worst_centre(scene, scale), 0.03);
    int observations = 0;
    for (const Landmark& landmark : scene.map.landmarks) {
      EXPECT_GE(landmark.observations.size(), 2U);
      for (const Observation& seen : landmark.observations) {
        EXPECT_EQ(scene.map.keyframes.at(seen.keyframe)
                      .landmarks[static_cast<std::size_t>(seen.keypoint)],
                  landmark.id);
        ++observations;
      }
    }
    EXPECT_EQ(observations, result.observations - result.removed_observations);
  }
}

/// A map of sights that are precise but for every third, which is wrong by so little that no gate
/// tells it.
MapScene map_with_poor_sights(Random& random) {
  MapOptions options;
  options.noise_px = 0.1;
  MapScene scene = make_box_map(options, random);
  for (Keyframe& keyframe : scene.map.keyframes) {
    auto features = std::make_shared<Features>(*keyframe.features);
    for (std::size_t k = 0; k < features->keypoints.size(); k += 3) {
      Eigen::Vector2f& pixel = features->keypoints[k].pixel;
      pixel = noisy(pixel.cast<double>(), 1.0, random).cast<float>();
    }
    keyframe.features = features;
  }
  return scene;
}

TEST(GlobalBundle, FollowsThePreciseMajority) {
  Random random(seed_of("GlobalBundle.FollowsThePreciseMajority"));
  MapScene scene = map_with_poor_sights(random);
  BundleProblem by_huber = collect_whole_map(scene.map, scene.camera, {});
  BundleSolve huber;
  huber.iterations = 30;
  solve_bundle(by_huber, huber);
  MapScene compared = scene;
  write_back(by_huber, compared.map);

  BundleOptions bundle;
  bundle.iterations = 20;
  global_bundle(scene.map, scene.camera, bundle);
  EXPECT_LT(worst_centre(scene, scale_to_truth(scene)),
            0.5 * worst_centre(compared, scale_to_truth(compared)));
  EXPECT_LT(worst_rotation_deg(scene), 0.5 * worst_rotation_deg(compared));
}

TEST(MeasureSpread, TellsHowPreciseMostSightsAre) {
  Random random(seed_of("MeasureSpread.TellsHowPreciseMostSightsAre"));
  MapOptions options;
  options.noise_px = 0.1;
  options.outlier_share = 0.1;
  const MapScene scene = make_box_map(options, random);
  BundleOptions bundle;
  bundle.levels.factor = 1.2;
  BundleProblem problem = collect_whole_map(scene.map, scene.camera, bundle);
  deactivate_outliers(problem);
  const ResidualSpread spread = measure_spread(problem);
  // About 2000 sights: the median of chi2 is known to 4 %.
  EXPECT_NEAR(spread.mono, 0.01, 0.0015);
  EXPECT_EQ(spread.depth, 1.0) << "there is none";
}

TEST(GlobalBundle, RefinesAFocalLengthThatIsFivePercentOff) {
  Random random(seed_of("GlobalBundle.RefinesAFocalLengthThatIsFivePercentOff"));
  for (const double wrong : {0.95, 1.05}) {
    MapOptions options;
    options.noise_px = 0.3;
    options.keyframes = 10;
    MapScene scene = make_box_map(options, random);
    const double true_fx = scene.camera.fx;
    scene.camera.fx *= wrong;
    scene.camera.fy *= wrong;
    BundleOptions bundle;
    bundle.refine_focal = true;
    bundle.focal_independence = 1.0;  // the noise is each pixel's own
    bundle.iterations = 30;
    const BundleResult result = global_bundle(scene.map, scene.camera, bundle);
    EXPECT_NEAR(scene.camera.fx / true_fx, 1.0, 0.005);
    EXPECT_NEAR(scene.camera.fx / (true_fx * wrong), result.focal_factor, 1e-12);
    EXPECT_LT(result.rms_after_px, 0.6);
  }
}

TEST(GlobalBundle, KeepsTheGuessWhereTheViewsLeaveTheFocalLengthOpen) {
  // A camera that moves along a wall without turning: a longer lens and a farther wall look alike.
  Random random(seed_of("GlobalBundle.KeepsTheGuessWhereTheViewsLeaveTheFocalLengthOpen"));
  std::vector<Eigen::Vector3d> wall;
  for (int i = 0; i < 200; ++i) {
    wall.emplace_back(random.uniform() * 4.0 - 2.0, random.uniform() * 3.0 - 1.5, 4.0);
  }
  MapOptions options;
  MapScene scene = make_map(wall, options, random);
  for (Keyframe& keyframe : scene.map.keyframes) {
    keyframe.cam_from_world = pose_at({0.1 * keyframe.id, 0.0, 0.0}, {0.0, 0.0, 0.0});
    auto features = std::make_shared<Features>(*keyframe.features);
    for (std::size_t k = 0; k < features->keypoints.size(); ++k) {
      const Eigen::Vector3d& point = scene.map.landmarks.at(keyframe.landmarks[k]).position;
      features->keypoints[k].pixel =
          noisy(scene.camera.project(keyframe.cam_from_world * point), 0.3, random).cast<float>();
    }
    keyframe.features = features;
  }
  BundleOptions bundle;
  bundle.refine_focal = true;
  bundle.iterations = 30;
  Map free_map = scene.map;
  Camera free_camera = scene.camera;
  bundle.focal_sigma = 1e3;
  const double without = std::abs(global_bundle(free_map, free_camera, bundle).focal_factor - 1.0);
  bundle.focal_sigma = BundleOptions().focal_sigma;
  const double with = std::abs(global_bundle(scene.map, scene.camera, bundle).focal_factor - 1.0);
  EXPECT_LT(with, 0.5 * bundle.focal_sigma);
  EXPECT_LT(with, without);
}

TEST(GlobalBundle, SurvivesPointsBehindCamerasAndAnEmptyMap) {
  Random random(seed_of("GlobalBundle.SurvivesPointsBehindCamerasAndAnEmptyMap"));
  MapScene scene = make_box_map({}, random);
  scene.map.landmarks.at(3).position = {0.0, 0.0, -2.0};
  scene.map.landmarks.at(4).position.setConstant(std::nan(""));
  const BundleResult result = global_bundle(scene.map, scene.camera, {});
  EXPECT_LT(result.rms_after_px, 1e-3);
  EXPECT_FALSE(scene.map.landmarks.contains(3));
  EXPECT_FALSE(scene.map.landmarks.contains(4));
  Map empty;
  EXPECT_EQ(global_bundle(empty, scene.camera, {}).observations, 0);
  EXPECT_EQ(local_bundle(empty, scene.camera, 0, {}).observations, 0);
}

TEST(GlobalBundle, IsRepeatableToTheBit) {
  Random random(seed_of("GlobalBundle.IsRepeatableToTheBit"));
  MapOptions options;
  options.noise_px = 0.5;
  options.outlier_share = 0.03;
  for (const bool refine_focal : {false, true}) {
    MapScene first = make_box_map(options, random);
    perturb(first.map, 1, 0.01, 0.02, 0.03, random);
    MapScene second = first;
    // Moves what follows to other addresses.
    const std::vector<std::vector<double>> ballast(100, std::vector<double>(77));
    BundleOptions bundle;
    bundle.refine_focal = refine_focal;
    global_bundle(first.map, first.camera, bundle);
    global_bundle(second.map, second.camera, bundle);
    EXPECT_EQ(different_bits(first.map, second.map), 0);
    EXPECT_EQ(first.camera.fx, second.camera.fx);
  }
}

/// A wide scene, so that neighbours share more than distant keyframes do.
MapScene make_wide_map(Random& random) {
  MapOptions options;
  options.keyframes = 8;
  options.step = 0.4;
  std::vector<Eigen::Vector3d> points = box_points(800, random);
  for (Eigen::Vector3d& point : points) point.x() = 3.0 * point.x() + 2.0;
  return make_map(points, options, random);
}

TEST(LocalBundle, MovesTheWindowAndHoldsTheRest) {
  Random random(seed_of("LocalBundle.MovesTheWindowAndHoldsTheRest"));
  MapScene scene = make_wide_map(random);
  for (const KeyframeId id : {5, 6, 7}) {
    Keyframe& keyframe = scene.map.keyframes.at(id);
    keyframe.cam_from_world =
        pose_at(0.02 * gaussian3(random), 0.005 * gaussian3(random)) * keyframe.cam_from_world;
  }
  const Map before = scene.map;
  BundleOptions bundle;
  bundle.max_local_keyframes = 3;
  bundle.iterations = 20;
  const BundleResult result = local_bundle(scene.map, scene.camera, 7, bundle);
  EXPECT_EQ(result.free_keyframes, 3);
  EXPECT_GE(result.fixed_keyframes, 2);
  int moved = 0;
  for (const Keyframe& keyframe : scene.map.keyframes) {
    moved += keyframe.cam_from_world.matrix() !=
             before.keyframes.at(keyframe.id).cam_from_world.matrix();
  }
  EXPECT_EQ(moved, 3);
  EXPECT_LT(result.rms_after_px, 1e-3);
  EXPECT_LT(worst_rotation_deg(scene), 1e-3);
  EXPECT_LT(worst_centre(scene), 1e-4);
}

TEST(LocalBundle, HoldsTheGaugeWhenTheWindowIsTheWholeMap) {
  Random random(seed_of("LocalBundle.HoldsTheGaugeWhenTheWindowIsTheWholeMap"));
  MapOptions options;
  options.keyframes = 4;
  MapScene scene = make_box_map(options, random);
  perturb(scene.map, 1, 0.005, 0.01, 0.02, random);
  const double baseline = scene.map.keyframes.at(1).centre_world().norm();
  const BundleResult result = local_bundle(scene.map, scene.camera, 3, {});
  EXPECT_EQ(result.fixed_keyframes, 1);
  EXPECT_LT(result.rms_after_px, 1e-2);
  EXPECT_EQ(scene.map.keyframes.at(0).cam_from_world.matrix(), Pose::Identity().matrix());
  EXPECT_NEAR(scene.map.keyframes.at(1).centre_world().norm(), baseline, 1e-9);
}

TEST(LocalBundle, LimitsTheFixedKeyframes) {
  Random random(seed_of("LocalBundle.LimitsTheFixedKeyframes"));
  MapScene scene = make_wide_map(random);
  BundleOptions bundle;
  bundle.max_local_keyframes = 2;
  bundle.max_fixed_keyframes = 3;
  const BundleResult result = local_bundle(scene.map, scene.camera, 7, bundle);
  EXPECT_EQ(result.free_keyframes, 2);
  EXPECT_EQ(result.fixed_keyframes, 3);
}

}  // namespace
}  // namespace planecast::slam
