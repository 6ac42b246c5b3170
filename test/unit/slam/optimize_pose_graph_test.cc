#include "slam/optimize/pose_graph.h"

#include <gtest/gtest.h>

#include "slam/optimize/similarity.h"
#include "slam/optimize/similarity_cost.h"
#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;
using Vector7 = Eigen::Matrix<double, 7, 1>;

Similarity random_similarity(Random& random, double turn, double scale_spread) {
  Similarity s;
  s.rotation = pose_at(Eigen::Vector3d::Zero(), turn * gaussian3(random)).linear();
  s.translation = gaussian3(random);
  s.scale = std::exp(scale_spread * gaussian(random));
  return s;
}

double difference(const Similarity& a, const Similarity& b) {
  return (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm() +
         std::abs(std::log(a.scale / b.scale));
}

TEST(Similarity, InverseAndProductAreThoseOfTheMapping) {
  Random random(seed_of("Similarity.InverseAndProductAreThoseOfTheMapping"));
  const Similarity a = random_similarity(random, 1.0, 0.4);
  const Similarity b = random_similarity(random, 1.0, 0.4);
  const Eigen::Vector3d p = gaussian3(random);
  EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
  EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-12);
}

/// Central differences over h = 1e-6 are exact to about 1e-9 of the values.
TEST(SimilarityEdgeCost, JacobiansAreTheNumericOnes) {
  Random random(seed_of("SimilarityEdgeCost.JacobiansAreTheNumericOnes"));
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-7;
  const SimilarityManifold manifold(true);
  for (const double turn : {1e-4, 0.1, 0.8}) {
    for (int round = 0; round < 10; ++round) {
      const Similarity from = random_similarity(random, 1.0, 0.3);
      const Similarity to = random_similarity(random, 1.0, 0.3);
      // The error's rotation stays well below pi, where Log has its cut.
      const SimilarityEdgeCost cost(random_similarity(random, turn, 0.2) * to * from.inverse(), 1.7,
                                    2.5);
      SimilarityBlock blocks[2] = {block_from_similarity(from), block_from_similarity(to)};
      const double* parameters[2] = {blocks[0].data(), blocks[1].data()};
      double residuals[7];
      double by_from[56], by_to[56];
      double* jacobians[2] = {by_from, by_to};
      ASSERT_TRUE(cost.Evaluate(parameters, residuals, jacobians));
      for (int b = 0; b < 2; ++b) {
        for (int column = 0; column < 7; ++column) {
          Vector7 residual[2];
          for (int side = 0; side < 2; ++side) {
            Vector7 delta = Vector7::Zero();
            delta(column) = side == 0 ? kStep : -kStep;
            SimilarityBlock moved;
            manifold.Plus(blocks[b].data(), delta.data(), moved.data());
            const double* shifted[2] = {b == 0 ? moved.data() : blocks[0].data(),
                                        b == 1 ? moved.data() : blocks[1].data()};
            ASSERT_TRUE(cost.Evaluate(shifted, residual[side].data(), nullptr));
          }
          const Vector7 numeric = (residual[0] - residual[1]) / (2.0 * kStep);
          for (int row = 0; row < 7; ++row) {
            EXPECT_NEAR(jacobians[b][row * 8 + column], numeric(row),
                        kTolerance * (1.0 + std::abs(numeric(row))));
          }
        }
      }
    }
  }
}

TEST(SimilarityManifold, MinusUndoesPlus) {
  Random random(seed_of("SimilarityManifold.MinusUndoesPlus"));
  for (const bool with_scale : {true, false}) {
    const SimilarityManifold manifold(with_scale);
    const SimilarityBlock x = block_from_similarity(random_similarity(random, 1.0, 0.3));
    Vector7 delta;
    for (int i = 0; i < 7; ++i) delta(i) = 0.3 * gaussian(random);
    SimilarityBlock y;
    manifold.Plus(x.data(), delta.data(), y.data());
    Vector7 back = delta;
    manifold.Minus(y.data(), x.data(), back.data());
    EXPECT_LT((back - delta).norm(), 1e-12);
    if (!with_scale) {
      EXPECT_EQ(y[7], x[7]);
    }
  }
}

TEST(RefineSimilarity, JacobianIsTheNumericOne) {
  Random random(seed_of("RefineSimilarity.JacobianIsTheNumericOne"));
  constexpr double kStep = 1e-6;
  const Camera camera = synthetic::camera();
  for (const Eigen::Vector3d& point : box_points(20, random)) {
    const Similarity truth = random_similarity(random, 0.1, 0.3);
    SimilarityPair pair;
    pair.point_b = point;
    pair.point_a = truth * point + 0.01 * gaussian3(random);
    if (pair.point_a.z() < 0.5) continue;
    pair.sigma_a_px = 1.2;
    pair.sigma_b_px = 2.0;
    constexpr double kDepthSigma = 0.05;
    slam::SimilarityResidual residual, plus, minus;
    SimilarityJacobian jacobian, ignored;
    ASSERT_TRUE(similarity_residual(camera, pair, truth, kDepthSigma, residual, jacobian));
    for (int column = 0; column < 7; ++column) {
      Vector7 delta = Vector7::Zero();
      delta(column) = kStep;
      ASSERT_TRUE(similarity_residual(camera, pair, perturb_left(truth, delta), kDepthSigma, plus,
                                      ignored));
      ASSERT_TRUE(similarity_residual(camera, pair, perturb_left(truth, -delta), kDepthSigma, minus,
                                      ignored));
      const slam::SimilarityResidual numeric = (plus - minus) / (2.0 * kStep);
      // Rounding of pixels of size 1e3 over the step.
      EXPECT_LT((jacobian.col(column) - numeric).norm(), 1e-6 * (1.0 + numeric.norm()) + 1e-5);
    }
  }
}

/// A ring of cameras whose odometry drifts by `drift` a step and is closed by one exact edge.
struct Ring {
  std::vector<Similarity> truth;
  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;
};

Ring make_ring(int count, double scale_drift, double turn_drift) {
  Ring ring;
  for (int i = 0; i < count; ++i) {
    const double a = 2.0 * M_PI * i / count;
    ring.truth.push_back(similarity_from_pose(
        pose_at({2.0 * std::cos(a), 2.0 * std::sin(a), 0.1 * std::sin(3 * a)}, {0.0, 0.0, a})));
  }
  Similarity step_error;
  step_error.rotation = pose_at(Eigen::Vector3d::Zero(), {0.0, turn_drift, 0.0}).linear();
  step_error.scale = std::exp(scale_drift);
  ring.nodes.push_back({ring.truth[0], true});
  for (int i = 1; i < count; ++i) {
    const Similarity exact = ring.truth[i] * ring.truth[i - 1].inverse();
    ring.edges.push_back({i - 1, i, step_error * exact, 1.0});
    ring.nodes.push_back({ring.edges.back().to_from_from * ring.nodes[i - 1].cam_from_world});
  }
  ring.edges.push_back({count - 1, 0, ring.truth[0] * ring.truth[count - 1].inverse(), 1.0});
  return ring;
}

double end_error(const Ring& ring) {
  const auto centre = [](const Similarity& s) -> Eigen::Vector3d {
    return s.inverse().translation;
  };
  return (centre(ring.nodes.back().cam_from_world) - centre(ring.truth.back())).norm();
}

TEST(PoseGraph, SpreadsTheDriftOfALoop) {
  constexpr int kCount = 40;
  for (const bool with_scale : {true, false}) {
    Ring ring = make_ring(kCount, with_scale ? 0.01 : 0.0, 0.004);
    const double before = end_error(ring);
    PoseGraphOptions options;
    options.with_scale = with_scale;
    const PoseGraphResult result = solve_pose_graph(ring.nodes, ring.edges, options);
    EXPECT_LT(result.cost_after, 0.1 * result.cost_before);
    // A loop of n equal edges leaves each with 1/n of the error that the last had.
    EXPECT_LT(end_error(ring), 3.0 * before / kCount);
    if (!with_scale) {
      for (const PoseGraphNode& node : ring.nodes)
        EXPECT_NEAR(node.cam_from_world.scale, 1.0, 1e-12);
    }
  }
}

TEST(PoseGraph, LeavesAConsistentGraphAloneAndRepeatsItself) {
  Ring exact = make_ring(12, 0.0, 0.0);
  solve_pose_graph(exact.nodes, exact.edges, {});
  for (std::size_t i = 0; i < exact.nodes.size(); ++i) {
    EXPECT_LT(difference(exact.nodes[i].cam_from_world, exact.truth[i]), 1e-9);
  }
  Ring a = make_ring(30, 0.01, 0.01);
  Ring b = make_ring(30, 0.01, 0.01);
  solve_pose_graph(a.nodes, a.edges, {});
  solve_pose_graph(b.nodes, b.edges, {});
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_EQ(difference(a.nodes[i].cam_from_world, b.nodes[i].cam_from_world), 0.0);
  }
}

/// Matches of two cameras with noise and gross outliers.
std::vector<SimilarityPair> noisy_pairs(const Camera& camera, const Similarity& a_from_b,
                                        int outliers, Random& random) {
  std::vector<SimilarityPair> pairs;
  for (const Eigen::Vector3d& point : box_points(120, random)) {
    SimilarityPair pair;
    pair.point_b = point + 0.005 * gaussian3(random);
    pair.point_a = a_from_b * point + 0.005 * gaussian3(random);
    if (pair.point_a.z() < 0.3) continue;
    pair.pixel_b = noisy(camera.project(point), 0.5, random);
    pair.pixel_a = noisy(camera.project(a_from_b * point), 0.5, random);
    if (static_cast<int>(pairs.size()) < outliers) pair.point_a += gaussian3(random);
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(SolveSimilarity, FindsScaleAndPoseAmongOutliers) {
  Random random(seed_of("SolveSimilarity.FindsScaleAndPoseAmongOutliers"));
  const Camera camera = synthetic::camera();
  for (const bool with_scale : {true, false}) {
    Similarity truth = random_similarity(random, 0.1, 0.0);
    truth.translation *= 0.3;
    truth.scale = with_scale ? 1.3 : 1.0;
    const std::vector<SimilarityPair> pairs = noisy_pairs(camera, truth, 40, random);
    SimilarityOptions options;
    options.with_scale = with_scale;
    const auto rough = solve_similarity(camera, pairs, options);
    ASSERT_TRUE(rough);
    SimilarityRefineOptions refine;
    refine.with_scale = with_scale;
    const SimilarityResult fine = refine_similarity(camera, pairs, rough->a_from_b, refine);
    EXPECT_GE(fine.num_inliers, rough->num_inliers);
    // 0.5 px over 80 points at 5 m and f = 525: 0.5 mm; half a thousandth of the scale.
    EXPECT_NEAR(fine.a_from_b.scale / truth.scale, 1.0, 2e-3);
    EXPECT_LT((fine.a_from_b.translation - truth.translation).norm(), 0.01);
    if (!with_scale) {
      EXPECT_EQ(fine.a_from_b.scale, 1.0);
    }
  }
}

TEST(SolveSimilarity, RefusesChance) {
  Random random(seed_of("SolveSimilarity.RefusesChance"));
  const Camera camera = synthetic::camera();
  std::vector<SimilarityPair> pairs = noisy_pairs(camera, Similarity(), 0, random);
  for (SimilarityPair& pair : pairs) {
    pair.point_a = box_points(1, random).front();
    pair.pixel_a = camera.project(pair.point_a);
  }
  EXPECT_FALSE(solve_similarity(camera, pairs, {}));
}

}  // namespace
}  // namespace planecast::slam
