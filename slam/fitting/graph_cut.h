#pragma once

#include <memory>
#include <vector>

#include "slam/fitting/neighbourhood.h"

namespace planecast::slam {

/// Inlier-outlier labelling by a minimum cut, with the energy of Graph-Cut RANSAC (Barath and
/// Matas, CVPR 2018, equations 1-3). K_p = exp(-r_p^2 / (2 eps^2)) is point p's kernel:
///   unary            p outlier: K_p                  p inlier: 1 - K_p
///   pair, x lambda   both outliers: (K_p + K_q) / 2  both inliers: 1 - (K_p + K_q) / 2  different:
///   1
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
             double lambda, std::vector<char>& inlier);

 private:
  struct Graph;
  std::unique_ptr<Graph> graph_;
  std::vector<long long> terminal_;
};

/// The energy of a labelling, as defined above; for tests and reports.
double labelling_energy(const std::vector<double>& kernel,
                        const std::vector<NeighbourPair>& neighbours, double lambda,
                        const std::vector<char>& inlier);

}  // namespace planecast::slam
