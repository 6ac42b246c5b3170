#include "slam/geometry/point_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

namespace planecast::slam {

namespace {

/// Third smallest squared distance from `point` to the others.
double third_nearest_squared(const std::vector<Eigen::Vector3d>& points, std::size_t self) {
  std::array<double, 3> best = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (std::size_t j = 0; j < points.size(); ++j) {
    if (j == self) continue;
    const double d = (points[j] - points[self]).squaredNorm();
    if (d >= best[2]) continue;
    best[2] = d;
    if (best[2] < best[1]) std::swap(best[2], best[1]);
    if (best[1] < best[0]) std::swap(best[1], best[0]);
  }
  return best[2];
}

double quantile(std::vector<double>& values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Diagonal of the box that holds the middle nine tenths of the points along each axis.
double extent_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d size;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    const double high = quantile(values, 0.95);
    size[axis] = high - quantile(values, 0.05);
  }
  return size.norm();
}

/// One point per occupied cell, the first.
std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points, double cell) {
  if (!(cell > 0.0)) return {};
  std::vector<std::tuple<long, long, long, std::size_t>> cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at = points[i] / cell;
    cells.emplace_back(std::lround(at.x()), std::lround(at.y()), std::lround(at.z()), i);
  }
  std::sort(cells.begin(), cells.end());
  const auto same_cell = [](const auto& a, const auto& b) {
    return std::get<0>(a) == std::get<0>(b) && std::get<1>(a) == std::get<1>(b) &&
           std::get<2>(a) == std::get<2>(b);
  };
  cells.erase(std::unique(cells.begin(), cells.end(), same_cell), cells.end());
  std::vector<Eigen::Vector3d> result;
  for (const auto& cell_of_point : cells) result.push_back(points[std::get<3>(cell_of_point)]);
  return result;
}

int find_root(std::vector<int>& parent, int i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

/// The axis along which the points spread most: the sweep's.
int widest_axis(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d low = points.front();
  Eigen::Vector3d high = points.front();
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  return axis;
}

std::vector<int> sorted_along(const std::vector<Eigen::Vector3d>& points, int axis) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return points[a][axis] != points[b][axis] ? points[a][axis] < points[b][axis] : a < b;
  });
  return order;
}

/// Renumbers roots by size of their cluster.
std::vector<int> number_by_size(std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> size(parent.size(), 0);
  for (int i = 0; i < n; ++i) ++size[find_root(parent, i)];
  std::vector<int> roots;
  for (int i = 0; i < n; ++i) {
    if (size[i] > 0) roots.push_back(i);
  }
  std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) { return size[a] > size[b]; });
  std::vector<int> number(parent.size(), 0);
  for (std::size_t k = 0; k < roots.size(); ++k) number[roots[k]] = static_cast<int>(k);
  std::vector<int> result(parent.size());
  for (int i = 0; i < n; ++i) result[i] = number[find_root(parent, i)];
  return result;
}

}  // namespace

double typical_spacing(const std::vector<Eigen::Vector3d>& all) {
  constexpr std::size_t kMostQueries = 200;
  constexpr double kQuantile = 0.85;
  constexpr double kCellsPerExtent = 40.0;
  if (all.size() < 4) return 0.0;
  const std::vector<Eigen::Vector3d> points = thinned(all, extent_of(all) / kCellsPerExtent);
  if (points.size() < 4) return 0.0;
  const std::size_t step = (points.size() + kMostQueries - 1) / kMostQueries;
  std::vector<double> squared;
  for (std::size_t i = 0; i < points.size(); i += step) {
    squared.push_back(third_nearest_squared(points, i));
  }
  return std::sqrt(quantile(squared, kQuantile));
}

std::vector<int> cluster_points(const std::vector<Eigen::Vector3d>& points, double link) {
  if (points.empty()) return {};
  const int axis = widest_axis(points);
  const std::vector<int> order = sorted_along(points, axis);
  std::vector<int> parent(points.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Eigen::Vector3d step = points[order[j]] - points[order[i]];
      if (step[axis] >= link) break;
      if (step.squaredNorm() >= link * link) continue;
      const int a = find_root(parent, order[i]);
      const int b = find_root(parent, order[j]);
      // The lower index becomes the root, so that numbering does not depend on the sweep.
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  return number_by_size(parent);
}

PointGap gap_between(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  PointGap gap;
  double least = HUGE_VAL;
  for (const Eigen::Vector3d& p : a) {
    for (const Eigen::Vector3d& q : b) {
      const double squared = (p - q).squaredNorm();
      if (!(squared < least)) continue;
      least = squared;
      gap = {p, q, std::sqrt(squared)};
    }
  }
  return gap;
}

}  // namespace planecast::slam
