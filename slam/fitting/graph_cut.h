#pragma once

#include <memory>
#include <vector>

#include "slam/fitting/neighbourhood.h"

namespace planecast::slam {

/// The weight of neighbours.
struct PairOptions {
  double lambda = 0.0;
  /// lambda_pq = lambda (1 - |K_p - K_q|) instead of lambda [D], as contrast weighs the pairs of a
  /// segmentation (Boykov and Jolly, ICCV 2001): of two neighbours one of which fits and one does
  /// not, neither says anything about the other, and what a mask leaked in takes no true points
  /// along.
  bool by_contrast = false;
};

/// Inlier-outlier labelling by a minimum cut, with the energy of Graph-Cut RANSAC (Barath and
/// Matas, CVPR 2018, equations 1-3). K_p = exp(-r_p^2 / (2 eps^2)) is point p's kernel:
///   unary            p outlier: K_p                  p inlier: 1 - K_p
///   pair, x lambda_pq  both outliers: (K_p + K_q) / 2  both inliers: 1 - (K_p + K_q) / 2
///                      different: 1
/// with lambda_pq as PairOptions says.
/// Later public implementations charge nothing for two far points both labelled inlier; with that
/// form a spatial cluster of gross outliers becomes inlier at the lambdas used here, with this one
/// it does not. A gross outlier amid inliers may still be labelled inlier: callers also gate by the
/// residual.
class GraphCut {
 public:
  GraphCut();
  ~GraphCut();
  GraphCut(const GraphCut&) = delete;
  GraphCut& operator=(const GraphCut&) = delete;

  /// Labels every point: inlier[p] = 1 or 0, ties outlier. Costs are exact to 2^-20. Reuses its
  /// memory.
  void label(const std::vector<double>& kernel, const std::vector<NeighbourPair>& neighbours,
             const PairOptions& options, std::vector<char>& inlier);

 private:
  struct Graph;
  struct Edge {
    int a = 0;
    int b = 0;
    long long weight = 0;
  };
  /// Fills terminal_, pull_ and edges_.
  void set_costs(const std::vector<double>& kernel, const std::vector<NeighbourPair>& neighbours,
                 const PairOptions& options);
  /// Labels what every minimum labels alike: a point whose own cost outweighs all its pairs
  /// together, then those that follow from it. Most points are such, and no flow is needed for
  /// them. Leaves the others in open_ and the pairs among them in edges_.
  void settle(std::vector<char>& inlier);
  /// Labels what is open by the maximum flow.
  void cut(std::vector<char>& inlier);

  std::unique_ptr<Graph> graph_;
  std::vector<long long> terminal_;  ///< cost of the label inlier less that of outlier
  std::vector<long long> pull_;      ///< sum of the weights of a point's edges
  std::vector<Edge> edges_;
  std::vector<int> open_;
  std::vector<char> is_open_;
  std::vector<int> vertex_;  ///< of the flow graph, per point
};

/// The energy of a labelling, as defined above; for tests and reports.
double labelling_energy(const std::vector<double>& kernel,
                        const std::vector<NeighbourPair>& neighbours, const PairOptions& options,
                        const std::vector<char>& inlier);

}  // namespace planecast::slam
