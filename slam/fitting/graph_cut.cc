#include "slam/fitting/graph_cut.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <opencv2/core.hpp>
// Needs core and the C headers above before it.
#include <opencv2/imgproc/detail/gcgraph.hpp>

namespace planecast::slam {

namespace {

/// Integer capacities: with floating point the solver's "== 0" tests can leave crumbs that never
/// saturate.
constexpr double kCapacityPerUnit = 1048576.0;

long long capacity(double cost) {
  const double scaled = cost * kCapacityPerUnit;
  return static_cast<long long>(scaled + (scaled < 0.0 ? -0.5 : 0.5));
}

double pair_weight(const std::vector<double>& kernel, const NeighbourPair& pair,
                   const PairOptions& options) {
  if (!options.by_contrast) return options.lambda;
  return options.lambda * (1.0 - std::abs(kernel[pair.a] - kernel[pair.b]));
}

}  // namespace

struct GraphCut::Graph {
  cv::detail::GCGraph<long long> solver;
};

GraphCut::GraphCut() : graph_(std::make_unique<Graph>()) {}
GraphCut::~GraphCut() = default;

void GraphCut::label(const std::vector<double>& kernel,
                     const std::vector<NeighbourPair>& neighbours, const PairOptions& options,
                     std::vector<char>& inlier) {
  set_costs(kernel, neighbours, options);
  inlier.resize(kernel.size());
  settle(inlier);
  if (!open_.empty()) cut(inlier);
}

void GraphCut::set_costs(const std::vector<double>& kernel,
                         const std::vector<NeighbourPair>& neighbours, const PairOptions& options) {
  const int n = static_cast<int>(kernel.size());
  // The pair term is E00 + u (x_p + x_q) + w [x_p != x_q] with x = 1 for an inlier,
  // u = lambda_pq (1 - K_p - K_q) / 2 and w = lambda_pq / 2, so it needs one symmetric edge.
  terminal_.resize(kernel.size());
  for (int p = 0; p < n; ++p) terminal_[p] = capacity(1.0 - 2.0 * kernel[p]);
  pull_.assign(kernel.size(), 0);
  edges_.clear();
  for (const NeighbourPair& pair : neighbours) {
    const double weight = pair_weight(kernel, pair, options);
    const long long u = capacity(0.5 * weight * (1.0 - kernel[pair.a] - kernel[pair.b]));
    const long long w = capacity(0.5 * weight);
    terminal_[pair.a] += u;
    terminal_[pair.b] += u;
    pull_[pair.a] += w;
    pull_[pair.b] += w;
    edges_.push_back({pair.a, pair.b, w});
  }
}

void GraphCut::settle(std::vector<char>& inlier) {
  const std::size_t n = terminal_.size();
  is_open_.assign(n, 1);
  open_.resize(n);
  std::iota(open_.begin(), open_.end(), 0);
  for (std::size_t before = n + 1; open_.size() < before && !open_.empty();) {
    before = open_.size();
    const auto is_settled = [&](int p) {
      if (terminal_[p] < pull_[p] && terminal_[p] >= -pull_[p]) return false;
      inlier[p] = terminal_[p] < 0;
      is_open_[p] = 0;
      return true;
    };
    open_.erase(std::remove_if(open_.begin(), open_.end(), is_settled), open_.end());
    // What is settled pulls its neighbours to its own side.
    const auto pull = [&](int settled, int other, long long weight) {
      terminal_[other] += inlier[settled] ? -weight : weight;
      pull_[other] -= weight;
    };
    const auto is_done = [&](const Edge& edge) {
      if (is_open_[edge.a] && is_open_[edge.b]) return false;
      if (is_open_[edge.a]) pull(edge.b, edge.a, edge.weight);
      if (is_open_[edge.b]) pull(edge.a, edge.b, edge.weight);
      return true;
    };
    edges_.erase(std::remove_if(edges_.begin(), edges_.end(), is_done), edges_.end());
  }
}

void GraphCut::cut(std::vector<char>& inlier) {
  auto& solver = graph_->solver;
  solver =
      cv::detail::GCGraph<long long>();  // copy of an empty one: the vectors keep their capacity
  solver.create(static_cast<unsigned>(open_.size()), static_cast<unsigned>(2 * edges_.size()));
  vertex_.resize(terminal_.size());
  // Source side = outlier, which is also where the solver leaves a vertex without preference.
  for (const int p : open_) {
    vertex_[p] = solver.addVtx();
    solver.addTermWeights(vertex_[p], std::max(terminal_[p], 0LL), std::max(-terminal_[p], 0LL));
  }
  for (const Edge& edge : edges_) {
    solver.addEdges(vertex_[edge.a], vertex_[edge.b], edge.weight, edge.weight);
  }
  solver.maxFlow();
  for (const int p : open_) inlier[p] = !solver.inSourceSegment(vertex_[p]);
}

double labelling_energy(const std::vector<double>& kernel,
                        const std::vector<NeighbourPair>& neighbours, const PairOptions& options,
                        const std::vector<char>& inlier) {
  double energy = 0.0;
  for (std::size_t p = 0; p < kernel.size(); ++p) energy += inlier[p] ? 1.0 - kernel[p] : kernel[p];
  for (const NeighbourPair& pair : neighbours) {
    const double mean = 0.5 * (kernel[pair.a] + kernel[pair.b]);
    const double weight = pair_weight(kernel, pair, options);
    if (inlier[pair.a] != inlier[pair.b]) {
      energy += weight;
    } else {
      energy += weight * (inlier[pair.a] ? 1.0 - mean : mean);
    }
  }
  return energy;
}

}  // namespace planecast::slam
