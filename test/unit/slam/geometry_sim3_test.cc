#include "slam/geometry/sim3.h"

#include <gtest/gtest.h>

#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

Similarity some_similarity(double scale) {
  Similarity truth;
  truth.scale = scale;
  truth.rotation = pose_at(Eigen::Vector3d::Zero(), {0.7, -1.9, 0.4}).linear();
  truth.translation = {3.0, -1.0, 0.5};
  return truth;
}

std::vector<Eigen::Vector3d> moved(const Similarity& similarity,
                                   const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Vector3d& point : points) result.push_back(similarity * point);
  return result;
}

TEST(AlignPoints, RecoversASimilarityExactly) {
  Random random(seed_of("AlignPoints.RecoversASimilarityExactly"));
  const auto source = box_points(30, random);
  for (const double scale : {1.0, 0.02, 40.0}) {
    const Similarity truth = some_similarity(scale);
    const Similarity found = align_points(source, moved(truth, source), true);
    EXPECT_NEAR(found.scale / truth.scale, 1.0, 1e-12);
    EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-12);
    EXPECT_LT((found.translation - truth.translation).norm(), 1e-12 * (1.0 + 10.0 * scale));
  }
}

TEST(AlignPoints, WithoutScaleIsRigid) {
  Random random(seed_of("AlignPoints.WithoutScaleIsRigid"));
  const auto source = box_points(30, random);
  const Similarity found = align_points(source, moved(some_similarity(2.0), source), false);
  EXPECT_EQ(found.scale, 1.0);
  EXPECT_LT((found.rotation - some_similarity(2.0).rotation).norm(), 1e-12);
}

TEST(AlignPoints, CoplanarAndMirroredPointsGiveARotation) {
  Random random(seed_of("AlignPoints.CoplanarAndMirroredPointsGiveARotation"));
  std::vector<Eigen::Vector3d> flat = box_points(10, random);
  for (Eigen::Vector3d& point : flat) point.z() = 2.0;
  const Similarity truth = some_similarity(1.5);
  const Similarity found = align_points(flat, moved(truth, flat), true);
  EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-9);

  const auto source = box_points(10, random);
  std::vector<Eigen::Vector3d> mirrored = source;
  for (Eigen::Vector3d& point : mirrored) point.x() = -point.x();
  EXPECT_NEAR(align_points(source, mirrored, true).rotation.determinant(), 1.0, 1e-12);
}

TEST(AlignPoints, IsTheLeastSquaresOptimum) {
  Random random(seed_of("AlignPoints.IsTheLeastSquaresOptimum"));
  const auto source = box_points(50, random);
  auto target = moved(some_similarity(2.0), source);
  for (Eigen::Vector3d& point : target) point += 0.05 * gaussian3(random);
  const Similarity best = align_points(source, target, true);
  const auto cost = [&](const Similarity& similarity) {
    double sum = 0.0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      sum += (similarity * source[i] - target[i]).squaredNorm();
    }
    return sum;
  };
  for (int k = 0; k < 7; ++k) {
    for (const double step : {1e-4, -1e-4}) {
      Similarity other = best;
      if (k < 3) {
        other.rotation = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(k)) * best.rotation;
      } else if (k < 6) {
        other.translation(k - 3) += step;
      } else {
        other.scale += step;
      }
      EXPECT_GT(cost(other), cost(best));
    }
  }
}

}  // namespace
}  // namespace planecast::slam
