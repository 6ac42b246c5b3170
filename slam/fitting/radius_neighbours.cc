// FLANN's and OpenCV's headers clash, so that FLANN comes first and stands in a file of its own.
#include <flann/flann.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "slam/fitting/neighbourhood.h"

namespace planecast::slam {

namespace {

using Index = ::flann::Index<::flann::L2_Simple<double>>;

/// The points as FLANN wants them: a row-major matrix that must outlive the index.
::flann::Matrix<double> as_matrix(const std::vector<Eigen::Vector3d>& points) {
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
  // FLANN takes a mutable pointer but only reads it (the index is built on a reordered copy).
  return {const_cast<double*>(points.data()->data()), points.size(), 3};
}

Index build_index(const ::flann::Matrix<double>& data) {
  constexpr int kLeafSize = 12;
  Index index(data, ::flann::KDTreeSingleIndexParams(kLeafSize));
  index.buildIndex();
  return index;
}

}  // namespace

std::vector<NeighbourPair> radius_neighbours(const std::vector<Eigen::Vector3d>& points,
                                             double radius, int max_neighbours) {
  std::vector<NeighbourPair> result;
  if (points.size() < 2 || radius <= 0.0) return result;
  const auto data = as_matrix(points);
  const Index index = build_index(data);
  ::flann::SearchParams params(::flann::FLANN_CHECKS_UNLIMITED, 0.0F, true);
  // A point finds itself first.
  params.max_neighbors = max_neighbours == kAllPairs ? -1 : max_neighbours + 1;
  std::vector<std::vector<std::size_t>> found;
  std::vector<std::vector<double>> squared;
  index.radiusSearch(data, found, squared, static_cast<float>(radius * radius), params);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const std::size_t j : found[i]) {
      if (j != i)
        result.push_back({static_cast<int>(std::min(i, j)), static_cast<int>(std::max(i, j))});
    }
  }
  sort_unique(result);
  return result;
}

NearestTable nearest_points(const std::vector<Eigen::Vector3d>& points, int count) {
  NearestTable table;
  table.count = count;
  table.index.assign(points.size() * static_cast<std::size_t>(count), -1);
  table.distance.assign(table.index.size(), HUGE_VAL);
  if (points.size() < 2) return table;
  const auto data = as_matrix(points);
  const Index index = build_index(data);
  const ::flann::SearchParams params(::flann::FLANN_CHECKS_UNLIMITED, 0.0F, true);
  std::vector<std::vector<std::size_t>> found;
  std::vector<std::vector<double>> squared;
  const std::size_t wanted = std::min(points.size(), static_cast<std::size_t>(count) + 1);
  index.knnSearch(data, found, squared, wanted, params);
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::size_t at = i * static_cast<std::size_t>(count);
    const std::size_t row_end = at + static_cast<std::size_t>(count);
    for (std::size_t k = 0; k < found[i].size() && at < row_end; ++k) {
      if (found[i][k] == i) continue;
      table.index[at] = static_cast<int>(found[i][k]);
      table.distance[at++] = std::sqrt(squared[i][k]);
    }
  }
  return table;
}

}  // namespace planecast::slam
