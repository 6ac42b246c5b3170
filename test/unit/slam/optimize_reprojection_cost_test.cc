#include "slam/optimize/reprojection_cost.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "slam/optimize/depth_plane_cost.h"
#include "test/unit/slam/synthetic_views.h"

namespace planecast::slam {
namespace {

using namespace synthetic;

constexpr double kStep = 1e-6;
/// Central differences of residuals of some 1e3 with steps of 1e-6: rounding 1e-7, third order
/// below it.
constexpr double kTolerance = 1e-4;

/// Parameter blocks by value; a null manifold stands for a Euclidean block.
struct Blocks {
  std::vector<std::vector<double>> values;
  std::vector<const ceres::Manifold*> manifolds;

  int tangent_size(std::size_t block) const {
    return manifolds[block] ? manifolds[block]->TangentSize()
                            : static_cast<int>(values[block].size());
  }
  Blocks moved(std::size_t block, int k, double by) const {
    Blocks result = *this;
    if (manifolds[block] == nullptr) {
      result.values[block][static_cast<std::size_t>(k)] += by;
      return result;
    }
    std::vector<double> delta(static_cast<std::size_t>(tangent_size(block)), 0.0);
    delta[static_cast<std::size_t>(k)] = by;
    manifolds[block]->Plus(values[block].data(), delta.data(), result.values[block].data());
    return result;
  }
  std::vector<const double*> pointers() const {
    std::vector<const double*> result;
    for (const auto& value : values) result.push_back(value.data());
    return result;
  }
};

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Compares every block's Jacobian, brought into the tangent space as Ceres does, with differences.
void check_jacobians(const ceres::CostFunction& cost, const Blocks& blocks) {
  const int rows = cost.num_residuals();
  std::vector<double> residuals(static_cast<std::size_t>(rows));
  std::vector<Matrix> jacobians;
  std::vector<double*> pointers;
  for (const auto& value : blocks.values) {
    jacobians.emplace_back(rows, static_cast<Eigen::Index>(value.size()));
  }
  for (Matrix& jacobian : jacobians) pointers.push_back(jacobian.data());
  ASSERT_TRUE(cost.Evaluate(blocks.pointers().data(), residuals.data(), pointers.data()));
  for (std::size_t block = 0; block < blocks.values.size(); ++block) {
    Matrix analytic = jacobians[block];
    if (const ceres::Manifold* manifold = blocks.manifolds[block]) {
      Matrix plus(manifold->AmbientSize(), manifold->TangentSize());
      manifold->PlusJacobian(blocks.values[block].data(), plus.data());
      analytic = (analytic * plus).eval();
    }
    for (int k = 0; k < blocks.tangent_size(block); ++k) {
      Eigen::VectorXd ahead(rows), behind(rows);
      cost.Evaluate(blocks.moved(block, k, kStep).pointers().data(), ahead.data(), nullptr);
      cost.Evaluate(blocks.moved(block, k, -kStep).pointers().data(), behind.data(), nullptr);
      const Eigen::VectorXd numeric = (ahead - behind) / (2 * kStep);
      for (int row = 0; row < rows; ++row) {
        EXPECT_NEAR(analytic(row, k), numeric(row), kTolerance * (1.0 + std::abs(numeric(row))))
            << "block " << block << " row " << row << " column " << k;
      }
    }
  }
}

std::vector<double> as_values(const PoseBlock& block) { return {block.begin(), block.end()}; }
std::vector<double> as_values(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

TEST(ReprojectionCost, JacobiansAreTheNumericOnes) {
  Random random(seed_of("ReprojectionCost.JacobiansAreTheNumericOnes"));
  const PoseManifold manifold;
  for (int i = 0; i < 50; ++i) {
    const Pose pose = pose_at(0.5 * gaussian3(random), 0.4 * gaussian3(random));
    const Eigen::Vector3d point =
        pose.inverse() * Eigen::Vector3d(gaussian(random), gaussian(random), 1.0 + i * 0.1);
    Blocks blocks{{as_values(block_from_pose(pose)), as_values(point)}, {&manifold, nullptr}};
    const Camera camera = synthetic::camera();
    const ReprojectionTerm mono(camera, 0.08, random_pixel(camera, random), 1.44, 0.0);
    const ReprojectionTerm depth(camera, 0.08, random_pixel(camera, random), 1.2, 2.5);
    check_jacobians(ReprojectionCost<2>(mono), blocks);
    check_jacobians(ReprojectionCost<3>(depth), blocks);
    blocks.values.push_back({1.05});
    blocks.manifolds.push_back(nullptr);
    check_jacobians(FocalReprojectionCost<2>(mono), blocks);
    check_jacobians(FocalReprojectionCost<3>(depth), blocks);
  }
}

TEST(FocalPriorCost, JacobianIsTheNumericOne) {
  for (const double factor : {0.8, 1.0, 1.3}) {
    check_jacobians(FocalPriorCost(0.1), {{{factor}}, {nullptr}});
  }
}

TEST(PointPlaneCost, JacobiansAreTheNumericOnes) {
  Random random(seed_of("PointPlaneCost.JacobiansAreTheNumericOnes"));
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d normal = gaussian3(random).normalized();
    check_jacobians(PointPlaneCost(0.01),
                    {{as_values(gaussian3(random)), as_values(normal), {gaussian(random)}},
                     {nullptr, nullptr, nullptr}});
  }
}

TEST(DepthPlaneCost, JacobiansAreTheNumericOnes) {
  Random random(seed_of("DepthPlaneCost.JacobiansAreTheNumericOnes"));
  const PoseManifold manifold;
  for (int i = 0; i < 20; ++i) {
    const Pose pose = pose_at(2.0 * gaussian3(random), gaussian3(random));
    const Eigen::Vector3d normal = gaussian3(random).normalized();
    check_jacobians(DepthPlaneCost(gaussian3(random), 0.01),
                    {{as_values(block_from_pose(pose)), as_values(normal), {gaussian(random)}},
                     {&manifold, nullptr, nullptr}});
  }
}

TEST(CentreDistanceCost, JacobianIsTheNumericOne) {
  Random random(seed_of("CentreDistanceCost.JacobianIsTheNumericOne"));
  const PoseManifold manifold;
  for (int i = 0; i < 20; ++i) {
    const Pose pose = pose_at(2.0 * gaussian3(random), gaussian3(random));
    check_jacobians(CentreDistanceCost(gaussian3(random), 1.5, 0.01),
                    {{as_values(block_from_pose(pose))}, {&manifold}});
  }
}

TEST(ReprojectionCost, IsZeroAtTheTruthAndHasNoValueBehindTheCamera) {
  const Camera camera = synthetic::camera();
  const Pose pose = pose_at({0.1, 0.2, -0.1}, {0.1, 0.0, 0.2});
  const Eigen::Vector3d point(0.3, -0.2, 4.0);
  const ReprojectionTerm term(camera, 0.08, camera.project(pose * point), 1.0, (pose * point).z());
  const PoseBlock block = block_from_pose(pose);
  EXPECT_LT(term.chi2(pose_from_block(block) * point, 1.0), 1e-18);

  const Eigen::Vector3d behind(0.0, 0.0, -4.0);
  EXPECT_TRUE(std::isinf(term.chi2(pose_from_block(block) * behind, 1.0)));
  double residuals[3], by_pose[21], by_point[9];
  EXPECT_FALSE(
      term.evaluate(block.data(), behind.data(), 1.0, residuals, by_pose, by_point, nullptr));
}

TEST(PoseManifold, MinusUndoesPlus) {
  Random random(seed_of("PoseManifold.MinusUndoesPlus"));
  const PoseManifold manifold;
  for (int i = 0; i < 20; ++i) {
    const PoseBlock x = block_from_pose(pose_at(gaussian3(random), gaussian3(random)));
    Eigen::Matrix<double, 6, 1> delta, back;
    delta << 0.5 * gaussian3(random), gaussian3(random);
    PoseBlock y;
    manifold.Plus(x.data(), delta.data(), y.data());
    manifold.Minus(y.data(), x.data(), back.data());
    EXPECT_TRUE(back.isApprox(delta, 1e-9));
    EXPECT_TRUE(pose_from_block(y).isApprox(pose_from_block(block_from_pose(pose_from_block(y)))));
  }
}

}  // namespace
}  // namespace planecast::slam
