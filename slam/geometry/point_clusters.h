#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace planecast::slam {

/// Spacing of points on a surface: the 85th percentile, over at most 200 evenly chosen points, of
/// the distance to the third nearest. Points are first thinned to one per cell of a fortieth of
/// their extent, so that crowds of features on a few things do not hide the sparse rest. About 1.2
/// / sqrt(rho) for points strewn with density rho; 0 for fewer than 4 points.
double typical_spacing(const std::vector<Eigen::Vector3d>& points);

/// Single-linkage clusters: points connected by steps shorter than `link`. The cluster of each
/// point; cluster 0 is the largest, ties by lowest point.
std::vector<int> cluster_points(const std::vector<Eigen::Vector3d>& points, double link);

/// Where two sets of points are nearest to one another.
struct PointGap {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< of the one
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    ///< of the other
  double distance = HUGE_VAL;                      ///< infinite if either is empty
};
PointGap gap_between(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);

}  // namespace planecast::slam
