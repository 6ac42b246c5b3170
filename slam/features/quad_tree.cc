#include "slam/features/quad_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <queue>
#include <utility>

namespace planecast::slam {
namespace {

struct Cell {
  cv::Rect2f area;
  std::vector<int> corners;
};

std::array<Cell, 4> split(const Cell& cell, const std::vector<cv::KeyPoint>& corners) {
  const float half_width = 0.5F * cell.area.width;
  const float half_height = 0.5F * cell.area.height;
  std::array<Cell, 4> quarters;
  for (int q = 0; q < 4; ++q) {
    quarters[static_cast<std::size_t>(q)].area =
        cv::Rect2f(cell.area.x + (q % 2) * half_width, cell.area.y + (q / 2) * half_height,
                   half_width, half_height);
  }
  for (const int index : cell.corners) {
    const cv::Point2f& point = corners[static_cast<std::size_t>(index)].pt;
    const std::size_t q = (point.x >= cell.area.x + half_width ? 1U : 0U) +
                          (point.y >= cell.area.y + half_height ? 2U : 0U);
    quarters[q].corners.push_back(index);
  }
  return quarters;
}

int strongest(const Cell& cell, const std::vector<cv::KeyPoint>& corners) {
  return *std::max_element(cell.corners.begin(), cell.corners.end(), [&](int a, int b) {
    const float ra = corners[static_cast<std::size_t>(a)].response;
    const float rb = corners[static_cast<std::size_t>(b)].response;
    return ra != rb ? ra < rb : a > b;
  });
}

/// Square-ish cells to begin with.
std::vector<Cell> first_cells(const std::vector<cv::KeyPoint>& corners, int width, int height) {
  const int columns = std::max(1, static_cast<int>(std::lround(double(width) / height)));
  const int rows = std::max(1, static_cast<int>(std::lround(double(height) / width)));
  const float cell_width = static_cast<float>(width) / static_cast<float>(columns);
  const float cell_height = static_cast<float>(height) / static_cast<float>(rows);
  std::vector<Cell> cells(static_cast<std::size_t>(columns * rows));
  for (int i = 0; i < columns * rows; ++i) {
    cells[static_cast<std::size_t>(i)].area =
        cv::Rect2f(static_cast<float>(i % columns) * cell_width,
                   static_cast<float>(i / columns) * cell_height, cell_width, cell_height);
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const int column = std::clamp(static_cast<int>(corners[k].pt.x / cell_width), 0, columns - 1);
    const int row = std::clamp(static_cast<int>(corners[k].pt.y / cell_height), 0, rows - 1);
    cells[static_cast<std::size_t>(row * columns + column)].corners.push_back(static_cast<int>(k));
  }
  return cells;
}

}  // namespace

std::vector<cv::KeyPoint> spread_corners(const std::vector<cv::KeyPoint>& corners, int width,
                                         int height, int limit) {
  if (static_cast<int>(corners.size()) <= limit) return corners;
  std::vector<Cell> cells = first_cells(corners, width, height);
  std::erase_if(cells, [](const Cell& cell) { return cell.corners.empty(); });

  // Fullest first; among equals the older cell. Splitting leaves the parent empty in its place.
  using Entry = std::pair<std::size_t, std::ptrdiff_t>;
  std::priority_queue<Entry> queue;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    queue.emplace(cells[i].corners.size(), -static_cast<std::ptrdiff_t>(i));
  }
  int occupied = static_cast<int>(cells.size());
  while (occupied < limit && !queue.empty()) {
    const auto [count, negative_index] = queue.top();
    queue.pop();
    const auto index = static_cast<std::size_t>(-negative_index);
    if (count <= 1 || cells[index].area.width < 1.0F) continue;
    std::array<Cell, 4> quarters = split(cells[index], corners);
    cells[index].corners.clear();
    --occupied;
    for (Cell& quarter : quarters) {
      if (quarter.corners.empty()) continue;
      queue.emplace(quarter.corners.size(), -static_cast<std::ptrdiff_t>(cells.size()));
      cells.push_back(std::move(quarter));
      ++occupied;
    }
  }

  std::vector<cv::KeyPoint> kept;
  kept.reserve(static_cast<std::size_t>(occupied));
  for (const Cell& cell : cells) {
    if (!cell.corners.empty()) {
      kept.push_back(corners[static_cast<std::size_t>(strongest(cell, corners))]);
    }
  }
  return kept;
}

}  // namespace planecast::slam
