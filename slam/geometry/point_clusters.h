#pragma once

#include <Eigen/Core>
#include <vector>

namespace planecast::slam {

/// Median distance of a point to its third nearest other point, over at most 200 evenly chosen
/// points; 0 for fewer than 4 points. For points strewn evenly over an area with density rho it is
/// 0.94 / sqrt(rho).
double median_spacing(const std::vector<Eigen::Vector3d>& points);

/// Single-linkage clusters: points connected by steps shorter than `link`. The cluster of each
/// point; cluster 0 is the largest, ties by lowest point.
std::vector<int> cluster_points(const std::vector<Eigen::Vector3d>& points, double link);

/// Smallest distance between a point of `a` and one of `b`; infinite if either is empty.
double gap_between(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);

}  // namespace planecast::slam
