#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <random>
#include <vector>

#include "planes_world.h"
#include "slam/fitting/fit_homography.h"
#include "slam/fitting/homography_model.h"
#include "slam/fitting/samplers.h"

namespace planecast::slam {
namespace {

constexpr double kNoisePx = 0.5;

struct Scene {
  Eigen::Matrix3d cur_H_ref;
  std::vector<PointPair> pairs;
  std::vector<float> quality;
  std::vector<char> is_outlier;
};

/// Two views of a plane by a hand-held camera: rotations of a few degrees, a tenth of the distance
/// moved.
Eigen::Matrix3d random_homography(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  const Camera camera = test_camera();
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Vector3d axis(normal(generator), normal(generator), normal(generator));
  const Eigen::Vector3d move(normal(generator), normal(generator), normal(generator));
  const Eigen::Vector3d tilt(0.3 * normal(generator), 0.3 * normal(generator), 1.0);
  const Eigen::Matrix3d r = Eigen::AngleAxisd(0.08, axis.normalized()).toRotationMatrix();
  return k * (r + 0.1 * move.normalized() * tilt.normalized().transpose()) * k.inverse();
}

Scene make_scene(std::mt19937& generator, int count, double outliers) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  Scene scene;
  scene.cur_H_ref = random_homography(generator);
  const auto anywhere = [&] {
    return Eigen::Vector2d(640.0 * uniform(generator), 480.0 * uniform(generator));
  };
  const auto noise = [&] {
    return Eigen::Vector2d(kNoisePx * normal(generator), kNoisePx * normal(generator));
  };
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d ref = anywhere();
    const bool outlier = uniform(generator) < outliers;
    const Eigen::Vector2d cur =
        outlier ? anywhere() : (scene.cur_H_ref * ref.homogeneous()).hnormalized();
    scene.pairs.push_back({ref + noise(), cur + noise()});
    scene.quality.push_back(
        static_cast<float>(40.0 + 10.0 * normal(generator) + (outlier ? 20.0 : 0.0)));
    scene.is_outlier.push_back(outlier);
  }
  return scene;
}

/// Mean transfer error against the truth over a grid of the reference image, pixels.
double transfer_error(const Eigen::Matrix3d& estimate, const Eigen::Matrix3d& truth) {
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y <= 480; y += 60) {
    for (int x = 0; x <= 640; x += 80, ++count) {
      const Eigen::Vector3d p(x, y, 1.0);
      sum += ((estimate * p).hnormalized() - (truth * p).hnormalized()).norm();
    }
  }
  return sum / count;
}

double magsac_error(const Scene& scene) {
  std::vector<cv::Point2f> ref;
  std::vector<cv::Point2f> cur;
  for (const PointPair& pair : scene.pairs) {
    ref.emplace_back(pair.ref.x(), pair.ref.y());
    cur.emplace_back(pair.cur.x(), pair.cur.y());
  }
  const cv::Mat h = cv::findHomography(ref, cur, cv::USAC_MAGSAC, 2.0);
  if (h.empty()) return 1e3;
  Eigen::Matrix3d estimate;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) estimate(r, c) = h.at<double>(r, c);
  }
  return transfer_error(estimate, scene.cur_H_ref);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

class HomographyAccuracy : public ::testing::TestWithParam<double> {};

TEST_P(HomographyAccuracy, IsThatOfMagsac) {
  auto generator = test_generator();
  std::vector<double> ours;
  std::vector<double> theirs;
  for (int trial = 0; trial < 25; ++trial) {
    const Scene scene = make_scene(generator, 400, GetParam());
    HomographyOptions options;
    options.seed = static_cast<std::uint64_t>(trial);
    const auto fit = fit_homography(scene.pairs, scene.quality, {}, options);
    ASSERT_TRUE(fit) << "trial " << trial;
    ours.push_back(transfer_error(fit->cur_H_ref, scene.cur_H_ref));
    theirs.push_back(magsac_error(scene));
    int marked_outliers = 0;
    int outliers = 0;
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
      outliers += scene.is_outlier[i];
      marked_outliers += fit->inlier[i] && scene.is_outlier[i];
    }
    // A random match falls within 2 px of its place with probability below 1e-4.
    EXPECT_LE(marked_outliers, 1 + outliers / 100);
    EXPECT_GT(fit->num_inliers, 0.8 * (400 - outliers));
  }
  EXPECT_LT(median(ours), 1.5 * median(theirs));
}

INSTANTIATE_TEST_SUITE_P(Outliers, HomographyAccuracy, ::testing::Values(0.15, 0.35, 0.55));

/// 300 matches of a mask: a surface in the left part of the image and, for 3 in 10 matches, the one
/// that adjoins it and turns away; 15 % gross outliers.
Scene make_leaky_scene(std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  const Camera camera = test_camera();
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Matrix3d r = Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Vector3d move(0.1 + 0.1 * uniform(generator), 0.1 * uniform(generator), 0.0);
  const Eigen::Vector3d tilt(0.4 * uniform(generator), 0.4 * uniform(generator), 1.0);
  const auto homography = [&](const Eigen::Vector3d& n, double distance) -> Eigen::Matrix3d {
    return k * (r + move * n.normalized().transpose() / distance) * k.inverse();
  };
  Scene scene;
  scene.cur_H_ref = homography(tilt, 2.0);
  const Eigen::Matrix3d other = homography(tilt + Eigen::Vector3d(1.2, 0, 0), 2.4);
  for (int i = 0; i < 300; ++i) {
    const bool leaked = i % 10 < 3;
    const bool gross = !leaked && uniform(generator) < 0.15;
    const double x =
        leaked ? 380.0 + 100.0 * uniform(generator) : 80.0 + 300.0 * uniform(generator);
    const Eigen::Vector2d ref(x, 60.0 + 360.0 * uniform(generator));
    Eigen::Vector2d cur = ((leaked ? other : scene.cur_H_ref) * ref.homogeneous()).hnormalized();
    if (gross) cur = {640.0 * uniform(generator), 480.0 * uniform(generator)};
    const auto noise = [&] {
      return Eigen::Vector2d(kNoisePx * normal(generator), kNoisePx * normal(generator));
    };
    scene.pairs.push_back({ref + noise(), cur + noise()});
    scene.is_outlier.push_back(leaked || gross);
  }
  return scene;
}

/// Share of the true matches marked, less that of the others.
double label_score(const Scene& scene, const std::optional<HomographyFit>& fit) {
  if (!fit) return 0.0;
  double right = 0.0, true_matches = 0.0, wrong = 0.0;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    true_matches += !scene.is_outlier[i];
    right += fit->inlier[i] && !scene.is_outlier[i];
    wrong += fit->inlier[i] && scene.is_outlier[i];
  }
  return (right - wrong) / true_matches;
}

TEST(FitHomography, WhatLeaksIntoAMaskDoesNotDrawTheFitAway) {
  auto generator = test_generator();
  constexpr int kTrials = 40;
  double with_cut = 0.0, plain = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Scene scene = make_leaky_scene(generator);
    HomographyOptions options;
    options.seed = static_cast<std::uint64_t>(trial);
    with_cut += label_score(scene, fit_homography(scene.pairs, {}, {}, options)) / kTrials;
    options.graph_cut = false;
    plain += label_score(scene, fit_homography(scene.pairs, {}, {}, options)) / kTrials;
  }
  EXPECT_GT(with_cut, plain);
  // 98 % of the true matches lie within 2 px; a fit that settled between the surfaces loses half.
  EXPECT_GT(with_cut, 0.93);
}

TEST(FitHomography, TwoRunsAreIdentical) {
  auto generator = test_generator();
  const Scene scene = make_scene(generator, 300, 0.4);
  const auto a = fit_homography(scene.pairs, scene.quality, {}, {});
  const auto b = fit_homography(scene.pairs, scene.quality, {}, {});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->cur_H_ref, b->cur_H_ref);
  EXPECT_EQ(a->inlier, b->inlier);
}

TEST(FitHomography, RandomMatchesGiveNone) {
  auto generator = test_generator();
  const Scene scene = make_scene(generator, 300, 1.0);
  EXPECT_FALSE(fit_homography(scene.pairs, {}, {}, {}));
  EXPECT_FALSE(fit_homography({}, {}, {}, {}));
  EXPECT_FALSE(fit_homography({scene.pairs.begin(), scene.pairs.begin() + 3}, {}, {}, {}));
}

TEST(FitHomography, OnePointRepeatedGivesNone) {
  const std::vector<PointPair> pairs(100, {{320.0, 240.0}, {330.0, 240.0}});
  EXPECT_FALSE(fit_homography(pairs, {}, {}, {}));
}

TEST(FitHomography, TheInstanceWithTheMostInliersWins) {
  auto generator = test_generator();
  Scene small = make_scene(generator, 80, 0.2);
  const Scene large = make_scene(generator, 200, 0.2);
  std::vector<int> labels(small.pairs.size(), 5);
  small.pairs.insert(small.pairs.end(), large.pairs.begin(), large.pairs.end());
  labels.insert(labels.end(), large.pairs.size(), 2);
  const auto fit = fit_homography(small.pairs, {}, labels, {});
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->label, 2);
  // 160 inliers at 0.5 px noise: the mean error is near 0.5 sqrt(8 / 160) = 0.1 px.
  EXPECT_LT(transfer_error(fit->cur_H_ref, large.cur_H_ref), 0.5);
}

TEST(HomographyModel, MinimalFitIsExactAndOriented) {
  auto generator = test_generator();
  const Eigen::Matrix3d truth = random_homography(generator);
  std::vector<PointPair> pairs;
  for (const Eigen::Vector2d& p :
       {Eigen::Vector2d(100, 100), Eigen::Vector2d(500, 120), Eigen::Vector2d(480, 400),
        Eigen::Vector2d(90, 380), Eigen::Vector2d(300, 110)}) {
    pairs.push_back({p, (truth * p.homogeneous()).hnormalized()});
  }
  const HomographyModel model(pairs);
  HomographyModel::Parameters fit;
  const int sample[] = {0, 1, 2, 3};
  ASSERT_TRUE(model.fit_minimal(sample, fit));
  EXPECT_LT(transfer_error(fit.cur_H_ref, truth), 1e-8);
  EXPECT_LT((fit.cur_H_ref * fit.ref_H_cur -
             Eigen::Matrix3d::Identity() * (fit.cur_H_ref * fit.ref_H_cur)(0, 0))
                .norm(),
            1e-8);
  ASSERT_TRUE(model.fit_least_squares({0, 1, 2, 3, 4}, fit));
  EXPECT_LT(transfer_error(fit.cur_H_ref, truth), 1e-5);
  // Seen in a mirror the triples turn the other way.
  for (PointPair& pair : pairs) pair.cur.x() = 640.0 - pair.cur.x();
  EXPECT_FALSE(model.fit_minimal(sample, fit));
}

TEST(ProgressiveNapsac, SamplesAreDistinctAndFirstLocal) {
  auto generator = test_generator();
  const Scene scene = make_scene(generator, 500, 0.0);
  ProgressiveNapsacSampler sampler(scene.pairs, 640, 480, 4);
  Random random(3);
  double first = 0.0;
  double last = 0.0;
  for (int k = 0; k < 20000; ++k) {
    int sample[4];
    sampler.draw(random, sample);
    double spread = 0.0;
    for (int i = 0; i < 4; ++i) {
      ASSERT_GE(sample[i], 0);
      ASSERT_LT(sample[i], 500);
      for (int j = 0; j < i; ++j) {
        ASSERT_NE(sample[i], sample[j]);
        spread = std::max(spread, (scene.pairs[sample[i]].ref - scene.pairs[sample[j]].ref).norm());
      }
    }
    if (k < 100) first += spread / 100.0;
    if (k >= 19900) last += spread / 100.0;
  }
  EXPECT_LT(first, 0.8 * last);
}

}  // namespace
}  // namespace planecast::slam
