#include "slam/fitting/neighbourhood.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace planecast::slam {

namespace {

int cell_coordinate(double value, int size, int cells) {
  const int cell = static_cast<int>(std::floor(value * cells / size));
  return std::clamp(cell, 0, cells - 1);
}

struct CellItem {
  int cell = 0;
  double x = 0.0;
  double y = 0.0;
  int index = 0;
};

/// Both images' cells in one number, so that equal numbers mean the same cell in both.
std::vector<CellItem> sorted_by_cell(const std::vector<PointPair>& pairs, int width, int height,
                                     int cells) {
  std::vector<CellItem> items(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [ref, cur] = pairs[i];
    int cell = cell_coordinate(ref.x(), width, cells);
    cell = cell * cells + cell_coordinate(ref.y(), height, cells);
    cell = cell * cells + cell_coordinate(cur.x(), width, cells);
    cell = cell * cells + cell_coordinate(cur.y(), height, cells);
    items[i] = {cell, ref.x(), ref.y(), static_cast<int>(i)};
  }
  std::sort(items.begin(), items.end(), [](const CellItem& a, const CellItem& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    if (a.x != b.x) return a.x < b.x;
    return a.index < b.index;
  });
  return items;
}

/// The nearest few, kept sorted by distance.
class Nearest {
 public:
  explicit Nearest(int capacity) : capacity_(std::min(capacity, kMost)) {}
  double worst() const { return size_ < capacity_ ? HUGE_VAL : items_[size_ - 1].first; }
  void offer(double squared_distance, int index) {
    if (squared_distance >= worst()) return;
    if (size_ < capacity_) ++size_;
    int at = size_ - 1;
    for (; at > 0 && items_[at - 1].first > squared_distance; --at) items_[at] = items_[at - 1];
    items_[at] = {squared_distance, index};
  }
  int size() const { return size_; }
  int index(int i) const { return items_[i].second; }

 private:
  static constexpr int kMost = 32;
  std::array<std::pair<double, int>, kMost> items_;
  int capacity_;
  int size_ = 0;
};

/// Sweeps outward from item i along x until the x distance alone exceeds the worst kept.
void link_nearest(const std::vector<CellItem>& items, int begin, int end, int i, int count,
                  std::vector<NeighbourPair>& out) {
  Nearest nearest(count);
  const CellItem& centre = items[i];
  const auto offer = [&](int j) {
    const double dx = items[j].x - centre.x;
    const double dy = items[j].y - centre.y;
    if (dx * dx >= nearest.worst()) return false;
    nearest.offer(dx * dx + dy * dy, items[j].index);
    return true;
  };
  for (int j = i + 1; j < end && offer(j); ++j) {
  }
  for (int j = i - 1; j >= begin && offer(j); --j) {
  }
  for (int k = 0; k < nearest.size(); ++k) {
    out.push_back(
        {std::min(centre.index, nearest.index(k)), std::max(centre.index, nearest.index(k))});
  }
}

void link_all(const std::vector<CellItem>& items, int begin, int end,
              std::vector<NeighbourPair>& out) {
  for (int i = begin; i < end; ++i) {
    for (int j = i + 1; j < end; ++j) {
      out.push_back(
          {std::min(items[i].index, items[j].index), std::max(items[i].index, items[j].index)});
    }
  }
}

}  // namespace

std::vector<NeighbourPair> image_grid_neighbours(const std::vector<PointPair>& pairs, int width,
                                                 int height, const GridOptions& options) {
  const std::vector<CellItem> items = sorted_by_cell(pairs, width, height, options.cells);
  const int n = static_cast<int>(items.size());
  std::vector<NeighbourPair> result;
  result.reserve(items.size() * kNearestNeighbours);
  for (int begin = 0, end = 0; begin < n; begin = end) {
    for (end = begin; end < n && items[end].cell == items[begin].cell;) ++end;
    if (options.max_neighbours == kAllPairs) {
      link_all(items, begin, end, result);
    } else {
      for (int i = begin; i < end; ++i) {
        link_nearest(items, begin, end, i, options.max_neighbours, result);
      }
    }
  }
  sort_unique(result);
  return result;
}

void sort_unique(std::vector<NeighbourPair>& pairs) {
  int n = 0;
  for (const NeighbourPair& pair : pairs) n = std::max(n, pair.b + 1);
  // Twice by counting, the second point first: points are many and pairs few per point.
  std::vector<NeighbourPair> sorted(pairs.size());
  std::vector<int> next(static_cast<std::size_t>(n) + 1);
  for (int NeighbourPair::*const key : {&NeighbourPair::b, &NeighbourPair::a}) {
    std::fill(next.begin(), next.end(), 0);
    for (const NeighbourPair& pair : pairs) ++next[pair.*key + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const NeighbourPair& pair : pairs) sorted[next[pair.*key]++] = pair;
    pairs.swap(sorted);
  }
  const auto is_same = [](const NeighbourPair& p, const NeighbourPair& q) {
    return p.a == q.a && p.b == q.b;
  };
  pairs.erase(std::unique(pairs.begin(), pairs.end(), is_same), pairs.end());
}

}  // namespace planecast::slam
