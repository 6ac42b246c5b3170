#include "slam/fitting/graph_cut.h"

#include <climits>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <opencv2/core.hpp>
// Needs core and the C headers above before it.
#include <opencv2/imgproc/detail/gcgraph.hpp>

namespace planecast::slam {

namespace {

/// Integer capacities: with floating point the solver's "== 0" tests can leave crumbs that never
/// saturate.
constexpr double kCapacityPerUnit = 1048576.0;

long long capacity(double cost) { return std::llround(cost * kCapacityPerUnit); }

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
  const int n = static_cast<int>(kernel.size());
  inlier.resize(kernel.size());
  // The pair term is E00 + u (x_p + x_q) + w [x_p != x_q] with x = 1 for an inlier,
  // u = lambda_pq (1 - K_p - K_q) / 2 and w = lambda_pq / 2, so it needs one symmetric edge.
  terminal_.resize(kernel.size());
  for (int p = 0; p < n; ++p) terminal_[p] = capacity(1.0 - 2.0 * kernel[p]);
  for (const NeighbourPair& pair : neighbours) {
    const double weight = pair_weight(kernel, pair, options);
    const long long u = capacity(0.5 * weight * (1.0 - kernel[pair.a] - kernel[pair.b]));
    terminal_[pair.a] += u;
    terminal_[pair.b] += u;
  }
  if (neighbours.empty()) {
    for (int p = 0; p < n; ++p) inlier[p] = terminal_[p] < 0;
    return;
  }
  auto& solver = graph_->solver;
  solver =
      cv::detail::GCGraph<long long>();  // copy of an empty one: the vectors keep their capacity
  solver.create(static_cast<unsigned>(n), static_cast<unsigned>(2 * neighbours.size()));
  // Source side = outlier, which is also where the solver leaves a vertex without preference.
  for (int p = 0; p < n; ++p) {
    solver.addVtx();
    solver.addTermWeights(p, std::max(terminal_[p], 0LL), std::max(-terminal_[p], 0LL));
  }
  for (const NeighbourPair& pair : neighbours) {
    const long long w = capacity(0.5 * pair_weight(kernel, pair, options));
    solver.addEdges(pair.a, pair.b, w, w);
  }
  solver.maxFlow();
  for (int p = 0; p < n; ++p) inlier[p] = !solver.inSourceSegment(p);
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
