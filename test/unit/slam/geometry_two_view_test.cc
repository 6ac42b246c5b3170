#include "slam/geometry/two_view.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

#include "slam/geometry/relative_pose.h"
#include "slam/geometry/triangulate.h"
#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

constexpr double kNoisePx = 0.5;
constexpr double kMaxPoseErrorDeg = 0.5;

struct Scene {
  Camera camera = synthetic::camera();
  Pose cur_from_ref;
  std::vector<Eigen::Vector3d> points;  ///< in the reference camera
  std::vector<PointPair> pairs;
  std::vector<char> is_outlier;
};

/// Pairs of all points, of which every fifth is an outlier when `outliers` is set.
void observe(Scene& scene, double noise_px, bool outliers, Random& random) {
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    PointPair pair;
    pair.ref = noisy(scene.camera.project(scene.points[i]), noise_px, random);
    pair.cur = noisy(scene.camera.project(scene.cur_from_ref * scene.points[i]), noise_px, random);
    scene.is_outlier.push_back(outliers && i % 5 == 0);
    if (scene.is_outlier.back()) pair.cur = random_pixel(scene.camera, random);
    scene.pairs.push_back(pair);
  }
}

Scene general_scene(Random& random, double noise_px = kNoisePx, bool outliers = true) {
  Scene scene;
  scene.cur_from_ref = pose_at({0.6, 0.1, 0.1}, {0.02, -0.08, 0.03});
  scene.points = box_points(400, random);
  observe(scene, noise_px, outliers, random);
  return scene;
}

/// A wall straight ahead, 4 units away, which an eye that moves along it sees without ambiguity.
struct PlanarScene : Scene {
  Eigen::Vector3d normal = Eigen::Vector3d(0.05, 0.1, 1.0).normalized();
  double distance = 4.0;

  Eigen::Matrix3d homography() const {
    const Eigen::Matrix3d k = calibration_matrix(camera);
    return k *
           (cur_from_ref.linear() + cur_from_ref.translation() * normal.transpose() / distance) *
           k.inverse();
  }
};

PlanarScene planar_scene(Random& random, double noise_px = kNoisePx, bool outliers = true) {
  PlanarScene scene;
  scene.cur_from_ref = pose_at({0.8, 0.2, 0.0}, {0.01, -0.1, 0.02});
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d ray = scene.camera.ray(random_pixel(scene.camera, random));
    scene.points.push_back(scene.distance / scene.normal.dot(ray) * ray);
  }
  observe(scene, noise_px, outliers, random);
  return scene;
}

void expect_pose(const Pose& estimate, const Pose& truth, double max_error_deg) {
  EXPECT_LT(rotation_error_deg(estimate, truth), max_error_deg);
  EXPECT_LT(direction_error_deg(estimate.translation(), truth.translation()), max_error_deg);
  EXPECT_NEAR(estimate.translation().norm(), 1.0, 1e-12);
}

double closest_candidate_deg(const std::vector<Pose>& candidates, const Pose& truth) {
  double closest = 180.0;
  for (const Pose& pose : candidates) {
    closest =
        std::min(closest, std::max(rotation_error_deg(pose, truth),
                                   direction_error_deg(pose.translation(), truth.translation())));
  }
  return closest;
}

TEST(Fundamental, FindsTheEpipolarGeometryAmongOutliers) {
  Random random(seed_of("Fundamental.FindsTheEpipolarGeometryAmongOutliers"));
  const Scene scene = general_scene(random);
  const auto result = find_fundamental(scene.pairs, {});
  ASSERT_TRUE(result);
  EXPECT_LT(std::abs(result->cur_F_ref.determinant()),
            1e-12 * std::pow(result->cur_F_ref.norm(), 3));
  int kept = 0, wrong = 0;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    (scene.is_outlier[i] ? wrong : kept) += result->inlier[i];
  }
  // 95 % gates in both images, at half the sigma that they are made for.
  EXPECT_GT(kept, 0.98 * 320);
  // A random pixel falls into the band of +-1.96 px about a line of some 600 px with about 1 %.
  EXPECT_LT(wrong, 5);
  EXPECT_GT(result->score, 0.0);
}

TEST(Fundamental, ScoreIsThatOfOrbSlam) {
  Random random(seed_of("Fundamental.ScoreIsThatOfOrbSlam"));
  const Scene scene = general_scene(random, 0.0, false);
  const auto result = find_fundamental(scene.pairs, {});
  ASSERT_TRUE(result);
  // Without noise every pair gives 5.991 in each direction.
  EXPECT_NEAR(result->score, 2 * 5.991 * static_cast<double>(scene.pairs.size()), 1e-6);
}

TEST(Fundamental, RefusesFewPairsAndIsRepeatable) {
  Random random(seed_of("Fundamental.RefusesFewPairsAndIsRepeatable"));
  const Scene scene = general_scene(random);
  EXPECT_FALSE(find_fundamental({scene.pairs.begin(), scene.pairs.begin() + 7}, {}));
  const auto first = find_fundamental(scene.pairs, {});
  const auto second = find_fundamental(scene.pairs, {});
  EXPECT_EQ(first->cur_F_ref, second->cur_F_ref);
  EXPECT_EQ(first->inlier, second->inlier);
}

TEST(Homography, ScoreCountsBothDirectionsAndMarksInliers) {
  Random random(seed_of("Homography.ScoreCountsBothDirectionsAndMarksInliers"));
  const PlanarScene exact = planar_scene(random, 0.0, true);
  std::vector<char> inlier;
  const double score = score_homography(exact.homography(), exact.pairs, 1.0, &inlier);
  EXPECT_NEAR(score, 2 * 5.991 * 320, 30.0);  // an outlier may hit by chance
  for (std::size_t i = 0; i < inlier.size(); ++i) {
    EXPECT_TRUE(inlier[i] || exact.is_outlier[i]) << i;
  }
  EXPECT_EQ(score_homography(Eigen::Matrix3d::Zero(), exact.pairs, 1.0, nullptr), 0.0);
}

TEST(Decompose, HomographyGivesTheTruePoseAmongFour) {
  Random random(seed_of("Decompose.HomographyGivesTheTruePoseAmongFour"));
  const PlanarScene scene = planar_scene(random);
  for (const double scale : {1.0, -0.3, 250.0}) {
    const auto candidates = decompose_homography(scale * scene.homography(), scene.camera);
    EXPECT_EQ(candidates.size(), 4U);
    EXPECT_LT(closest_candidate_deg(candidates, scene.cur_from_ref), 1e-5);
    for (const Pose& pose : candidates) {
      EXPECT_NEAR(pose.linear().determinant(), 1.0, 1e-9);
      EXPECT_NEAR(pose.translation().norm(), 1.0, 1e-9);
    }
  }
}

TEST(Decompose, HomographyOfMotionAlongTheNormal) {
  PlanarScene scene;
  scene.cur_from_ref = pose_at(scene.normal * 0.5, {0.0, 0.05, 0.0});
  const auto candidates = decompose_homography(scene.homography(), scene.camera);
  // The two middle singular values coincide to rounding: square roots of it, in radians, remain.
  EXPECT_LT(closest_candidate_deg(candidates, scene.cur_from_ref), 1e-4);
}

TEST(Decompose, RotationAndSingularMatricesGiveNothing) {
  const Camera camera = synthetic::camera();
  const Eigen::Matrix3d k = calibration_matrix(camera);
  const Pose turn = pose_at(Eigen::Vector3d::Zero(), {0.02, 0.1, -0.03});
  EXPECT_TRUE(decompose_homography(k * turn.linear() * k.inverse(), camera).empty());
  EXPECT_TRUE(decompose_homography(Eigen::Matrix3d::Zero(), camera).empty());
  EXPECT_TRUE(decompose_fundamental(Eigen::Matrix3d::Zero(), camera).empty());
}

TEST(Decompose, FundamentalGivesTheTruePoseAmongFour) {
  Random random(seed_of("Decompose.FundamentalGivesTheTruePoseAmongFour"));
  Scene scene = general_scene(random);
  for (const double sign : {1.0, -1.0}) {
    scene.camera.fy = sign * std::abs(scene.camera.fy);  // ICL-NUIM's is negative
    const Eigen::Matrix3d f =
        fundamental_from_poses(scene.camera, Pose::Identity(), scene.cur_from_ref);
    const auto candidates = decompose_fundamental(-3.0 * f, scene.camera);
    EXPECT_EQ(candidates.size(), 4U);
    EXPECT_LT(closest_candidate_deg(candidates, scene.cur_from_ref), 1e-6);
  }
}

TEST(RelativePose, GeneralSceneThroughTheFundamentalMatrix) {
  Random random(seed_of("RelativePose.GeneralSceneThroughTheFundamentalMatrix"));
  const Scene scene = general_scene(random);
  const auto fundamental = find_fundamental(scene.pairs, {});
  ASSERT_TRUE(fundamental);
  const auto result =
      select_relative_pose(decompose_fundamental(fundamental->cur_F_ref, scene.camera), scene.pairs,
                           fundamental->inlier, scene.camera, {});
  ASSERT_EQ(result.failure, TwoViewFailure::kNone);
  expect_pose(result.cur_from_ref, scene.cur_from_ref, kMaxPoseErrorDeg);
  EXPECT_GT(result.good, 300);
  EXPECT_GT(result.parallax_deg, 5.0);
  // Depth error of one pixel pair: z^2 sigma sqrt(2) / (f b), about 0.11 at z = 7; 4 sigma of that.
  const double scale = scene.cur_from_ref.translation().norm();
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (scene.is_outlier[i] || !result.points_ref[i]) continue;
    EXPECT_LT((scale * *result.points_ref[i] - scene.points[i]).norm(), 0.45);
  }
}

/// Least squares over the pairs that are no outliers.
Eigen::Matrix3d fitted_homography(const Scene& scene) {
  std::vector<cv::Point2d> ref, cur;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    if (scene.is_outlier[i]) continue;
    ref.emplace_back(scene.pairs[i].ref.x(), scene.pairs[i].ref.y());
    cur.emplace_back(scene.pairs[i].cur.x(), scene.pairs[i].cur.y());
  }
  const cv::Matx33d fitted = cv::findHomography(ref, cur, 0);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(fitted.val);
}

TEST(RelativePose, PlanarSceneThroughTheHomography) {
  Random random(seed_of("RelativePose.PlanarSceneThroughTheHomography"));
  const PlanarScene scene = planar_scene(random);
  const Eigen::Matrix3d homography = fitted_homography(scene);
  std::vector<char> inlier;
  score_homography(homography, scene.pairs, 1.0, &inlier);
  const auto result = select_relative_pose(decompose_homography(homography, scene.camera),
                                           scene.pairs, inlier, scene.camera, {});
  ASSERT_EQ(result.failure, TwoViewFailure::kNone);
  EXPECT_LT(rotation_error_deg(result.cur_from_ref, scene.cur_from_ref), kMaxPoseErrorDeg);
  // On a plane a turn is nearly a sideways step: the direction is less certain than the rotation.
  EXPECT_LT(
      direction_error_deg(result.cur_from_ref.translation(), scene.cur_from_ref.translation()),
      4 * kMaxPoseErrorDeg);
}

TEST(RelativePose, RefusesPureRotation) {
  Random random(seed_of("RelativePose.RefusesPureRotation"));
  Scene scene;
  scene.cur_from_ref = pose_at(Eigen::Vector3d::Zero(), {0.03, 0.12, -0.02});
  scene.points = box_points(400, random);
  observe(scene, kNoisePx, true, random);
  const auto fundamental = find_fundamental(scene.pairs, {});
  ASSERT_TRUE(fundamental);
  const auto result =
      select_relative_pose(decompose_fundamental(fundamental->cur_F_ref, scene.camera), scene.pairs,
                           fundamental->inlier, scene.camera, {});
  EXPECT_NE(result.failure, TwoViewFailure::kNone);

  const Eigen::Matrix3d h = fitted_homography(scene);
  std::vector<char> inlier;
  score_homography(h, scene.pairs, 1.0, &inlier);
  const auto from_homography = select_relative_pose(decompose_homography(h, scene.camera),
                                                    scene.pairs, inlier, scene.camera, {});
  EXPECT_NE(from_homography.failure, TwoViewFailure::kNone);
}

TEST(RelativePose, AFewNearPointsDoNotMakeAStart) {
  Random random(seed_of("RelativePose.AFewNearPointsDoNotMakeAStart"));
  Scene scene;
  scene.cur_from_ref = pose_at({0.03, 0.0, 0.0}, {0.0, 0.02, 0.0});
  scene.points = box_points(400, random);
  // A step of 3 cm is 1.7 degrees at 1 m, 0.57 at 3 m.
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    scene.points[i] *= (i < 80 ? 1.0 : 3.0) / scene.points[i].z();
  }
  observe(scene, 0.0, false, random);
  Pose truth = scene.cur_from_ref;
  truth.translation().normalize();
  const std::vector<char> all(scene.pairs.size(), 1);
  const auto result = select_relative_pose({truth}, scene.pairs, all, scene.camera, {});
  EXPECT_GT(result.parallax_deg, 1.5);
  EXPECT_NEAR(result.median_parallax_deg, 0.5, 0.1);
  EXPECT_EQ(result.failure, TwoViewFailure::kTooLittleParallax);
}

TEST(RelativePose, RefusesFewMatches) {
  Random random(seed_of("RelativePose.RefusesFewMatches"));
  const Scene scene = general_scene(random);
  std::vector<char> inlier(scene.pairs.size(), 0);
  std::fill_n(inlier.begin(), 49, 1);
  const auto result =
      select_relative_pose({scene.cur_from_ref}, scene.pairs, inlier, scene.camera, {});
  EXPECT_EQ(result.failure, TwoViewFailure::kTooFewMatches);
  EXPECT_EQ(result.points_ref.size(), scene.pairs.size());
}

TEST(RelativePose, ReportsAmbiguity) {
  Random random(seed_of("RelativePose.ReportsAmbiguity"));
  const Scene scene = general_scene(random, 0.0, false);
  Pose truth = scene.cur_from_ref;
  truth.translation().normalize();
  const std::vector<char> all(scene.pairs.size(), 1);
  EXPECT_EQ(select_relative_pose({truth, truth}, scene.pairs, all, scene.camera, {}).failure,
            TwoViewFailure::kAmbiguous);
  EXPECT_EQ(select_relative_pose({truth}, scene.pairs, all, scene.camera, {}).failure,
            TwoViewFailure::kNone);
}

TEST(Sampson, JacobianIsTheNumericOne) {
  Random random(seed_of("Sampson.JacobianIsTheNumericOne"));
  constexpr double kStep = 1e-6;
  for (int pose = 0; pose < 10; ++pose) {
    Pose truth = pose_at(gaussian3(random), 0.3 * gaussian3(random));
    truth.translation().normalize();
    const SampsonModel model(truth);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3d ref(0.5 * gaussian(random), 0.5 * gaussian(random), 1.0);
      const Eigen::Vector3d cur(0.5 * gaussian(random), 0.5 * gaussian(random), 1.0);
      const SampsonTerm term = model.evaluate(ref, cur);
      for (int k = 0; k < 5; ++k) {
        const Eigen::Matrix<double, 5, 1> step = kStep * Eigen::Matrix<double, 5, 1>::Unit(k);
        const double ahead = SampsonModel(model.stepped(step)).evaluate(ref, cur).residual;
        const double behind = SampsonModel(model.stepped(-step)).evaluate(ref, cur).residual;
        EXPECT_NEAR(term.jacobian(k), (ahead - behind) / (2 * kStep), 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace planecast::slam
