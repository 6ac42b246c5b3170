#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/geometry/two_view.h"

namespace planecast::slam {

/// Two neighbouring data points, a < b.
struct NeighbourPair {
  int a = 0;
  int b = 0;
};

/// [D] the paper's all-pairs grow with the square of a cell's content.
inline constexpr int kNearestNeighbours = 8;
/// `max_neighbours` for the paper's form.
inline constexpr int kAllPairs = 0;

/// Ascending, every pair once.
void sort_unique(std::vector<NeighbourPair>& pairs);

struct GridOptions {
  int cells = 8;  ///< per axis of both images [P]
  int max_neighbours = kNearestNeighbours;
};

/// Matches are neighbours if they share the grid cell in both images; of those each keeps its
/// nearest (in the reference image). Every unordered pair once, ascending. O(n sqrt(cell))
/// typically, no matrix.
std::vector<NeighbourPair> image_grid_neighbours(const std::vector<PointPair>& pairs, int width,
                                                 int height, const GridOptions& options = {});

/// Points closer than `radius`; of those each keeps its nearest. FLANN's exact single KD-tree,
/// which is repeatable, unlike its randomised indices. Every unordered pair once, ascending.
std::vector<NeighbourPair> radius_neighbours(const std::vector<Eigen::Vector3d>& points,
                                             double radius,
                                             int max_neighbours = kNearestNeighbours);

/// The `count` nearest other points of each point and their distances, row-major, nearest first;
/// fewer points than that leave -1 and infinity.
struct NearestTable {
  int count = 0;
  std::vector<int> index;
  std::vector<double> distance;
};
NearestTable nearest_points(const std::vector<Eigen::Vector3d>& points, int count);

}  // namespace planecast::slam
