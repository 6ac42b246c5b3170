#include "slam/features/quad_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <queue>
#include <utility>

namespace planecast::slam {
namespace {

/// The corners order[begin..end) lie in it.
struct Cell {
  cv::Rect2f area;
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t count() const { return end - begin; }
};

/// Sorts order[begin..end) by group, keeping the order within each; returns where the groups begin
/// and the last one ends.
template <typename GroupOf>
std::vector<std::size_t> sort_by_group(std::vector<int>& order, std::size_t begin, std::size_t end,
                                       std::size_t groups, const GroupOf& group_of,
                                       std::vector<int>& scratch) {
  std::vector<std::size_t> bounds(groups + 1, 0);
  for (std::size_t i = begin; i < end; ++i) ++bounds[group_of(order[i]) + 1];
  bounds[0] = begin;
  for (std::size_t g = 1; g <= groups; ++g) bounds[g] += bounds[g - 1];
  scratch.assign(order.begin() + static_cast<std::ptrdiff_t>(begin),
                 order.begin() + static_cast<std::ptrdiff_t>(end));
  std::vector<std::size_t> next = bounds;
  for (const int index : scratch) order[next[group_of(index)]++] = index;
  return bounds;
}

class QuadTree {
 public:
  QuadTree(const std::vector<cv::KeyPoint>& corners, int width, int height) : corners_(corners) {
    order_.resize(corners.size());
    std::iota(order_.begin(), order_.end(), 0);
    // Square-ish cells to begin with.
    const int columns = std::max(1, static_cast<int>(std::lround(double(width) / height)));
    const int rows = std::max(1, static_cast<int>(std::lround(double(height) / width)));
    const float cell_width = static_cast<float>(width) / static_cast<float>(columns);
    const float cell_height = static_cast<float>(height) / static_cast<float>(rows);
    const auto cell_of = [&](int index) {
      const cv::Point2f& point = corners[static_cast<std::size_t>(index)].pt;
      const int column = std::clamp(static_cast<int>(point.x / cell_width), 0, columns - 1);
      const int row = std::clamp(static_cast<int>(point.y / cell_height), 0, rows - 1);
      return static_cast<std::size_t>(row * columns + column);
    };
    const std::vector<std::size_t> bounds = sort_by_group(
        order_, 0, order_.size(), static_cast<std::size_t>(columns * rows), cell_of, scratch_);
    for (int i = 0; i < columns * rows; ++i) {
      const auto cell = static_cast<std::size_t>(i);
      add({cv::Rect2f(static_cast<float>(i % columns) * cell_width,
                      static_cast<float>(i / columns) * cell_height, cell_width, cell_height),
           bounds[cell], bounds[cell + 1]});
    }
  }

  void split_until(int limit) {
    while (occupied_ < limit && !queue_.empty()) {
      const auto [count, negative_index] = queue_.top();
      queue_.pop();
      const auto index = static_cast<std::size_t>(-negative_index);
      if (count <= 1 || cells_[index].area.width < 1.0F) continue;
      const Cell parent = cells_[index];
      cells_[index].end = cells_[index].begin;
      --occupied_;
      split(parent);
    }
  }

  std::vector<cv::KeyPoint> strongest_of_each() const {
    std::vector<cv::KeyPoint> kept;
    kept.reserve(static_cast<std::size_t>(occupied_));
    for (const Cell& cell : cells_) {
      if (cell.count() > 0) kept.push_back(strongest(cell));
    }
    return kept;
  }

 private:
  void add(const Cell& cell) {
    if (cell.count() == 0) return;
    queue_.emplace(cell.count(), -static_cast<std::ptrdiff_t>(cells_.size()));
    cells_.push_back(cell);
    ++occupied_;
  }

  void split(const Cell& cell) {
    const float half_width = 0.5F * cell.area.width;
    const float half_height = 0.5F * cell.area.height;
    const auto quarter_of = [&](int index) {
      const cv::Point2f& point = corners_[static_cast<std::size_t>(index)].pt;
      return (point.x >= cell.area.x + half_width ? 1U : 0U) +
             (point.y >= cell.area.y + half_height ? 2U : 0U);
    };
    const std::vector<std::size_t> bounds =
        sort_by_group(order_, cell.begin, cell.end, 4, quarter_of, scratch_);
    for (int q = 0; q < 4; ++q) {
      const auto quarter = static_cast<std::size_t>(q);
      add({cv::Rect2f(cell.area.x + static_cast<float>(q % 2) * half_width,
                      cell.area.y + static_cast<float>(q / 2) * half_height, half_width,
                      half_height),
           bounds[quarter], bounds[quarter + 1]});
    }
  }

  const cv::KeyPoint& strongest(const Cell& cell) const {
    const int best = *std::max_element(
        order_.begin() + static_cast<std::ptrdiff_t>(cell.begin),
        order_.begin() + static_cast<std::ptrdiff_t>(cell.end), [&](int a, int b) {
          const float ra = corners_[static_cast<std::size_t>(a)].response;
          const float rb = corners_[static_cast<std::size_t>(b)].response;
          return ra != rb ? ra < rb : a > b;
        });
    return corners_[static_cast<std::size_t>(best)];
  }

  const std::vector<cv::KeyPoint>& corners_;
  std::vector<int> order_;
  std::vector<int> scratch_;
  std::vector<Cell> cells_;  ///< those that were split are empty
  /// Fullest first; among equals the older cell.
  std::priority_queue<std::pair<std::size_t, std::ptrdiff_t>> queue_;
  int occupied_ = 0;
};

}  // namespace

std::vector<cv::KeyPoint> spread_corners(const std::vector<cv::KeyPoint>& corners, int width,
                                         int height, int limit) {
  if (static_cast<int>(corners.size()) <= limit) return corners;
  QuadTree tree(corners, width, height);
  tree.split_until(limit);
  return tree.strongest_of_each();
}

}  // namespace planecast::slam
