#include "slam/optimize/pose_graph.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <memory>

#include "slam/optimize/similarity_cost.h"

namespace planecast::slam {
namespace {

ceres::Solver::Options solver_options(const PoseGraphOptions& options) {
  ceres::Solver::Options result;
  result.max_num_iterations = options.iterations;
  result.function_tolerance = 1e-9;
  result.num_threads = 1;
  result.logging_type = ceres::SILENT;
  // Eigen's own solver: the BLAS behind the others differs from machine to machine.
  result.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  result.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  return result;
}

}  // namespace

PoseGraphResult solve_pose_graph(std::vector<PoseGraphNode>& nodes,
                                 const std::vector<PoseGraphEdge>& edges,
                                 const PoseGraphOptions& options) {
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  SimilarityManifold manifold(options.with_scale);
  // One array, as Ceres orders blocks by address: so the order is that of the nodes.
  std::vector<SimilarityBlock> blocks;
  blocks.reserve(nodes.size());
  for (const PoseGraphNode& node : nodes) {
    blocks.push_back(block_from_similarity(node.cam_from_world));
  }
  std::vector<std::unique_ptr<SimilarityEdgeCost>> costs;
  costs.reserve(edges.size());
  ceres::Problem problem(ownership);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    problem.AddParameterBlock(blocks[i].data(), static_cast<int>(blocks[i].size()), &manifold);
    if (nodes[i].fixed) problem.SetParameterBlockConstant(blocks[i].data());
  }
  for (const PoseGraphEdge& edge : edges) {
    costs.push_back(
        std::make_unique<SimilarityEdgeCost>(edge.to_from_from, edge.weight, options.length));
    problem.AddResidualBlock(costs.back().get(), nullptr,
                             blocks[static_cast<std::size_t>(edge.from)].data(),
                             blocks[static_cast<std::size_t>(edge.to)].data());
  }
  PoseGraphResult result;
  if (edges.empty()) return result;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(options), &problem, &summary);
  result.cost_before = summary.initial_cost;
  result.cost_after = summary.final_cost;
  result.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].fixed) nodes[i].cam_from_world = similarity_from_block(blocks[i].data());
  }
  return result;
}

}  // namespace planecast::slam
