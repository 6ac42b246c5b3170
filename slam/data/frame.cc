#include "slam/data/frame.h"

#include <algorithm>
#include <cmath>

namespace planecast::slam {
namespace {

constexpr int kCellPx = 16;

}  // namespace

void Features::build_grid(int width, int height) {
  grid_cols_ = std::max(1, (width + kCellPx - 1) / kCellPx);
  grid_rows_ = std::max(1, (height + kCellPx - 1) / kCellPx);
  const auto cell_of = [&](const Keypoint& keypoint) {
    const int col = std::clamp(static_cast<int>(keypoint.pixel.x()) / kCellPx, 0, grid_cols_ - 1);
    const int row = std::clamp(static_cast<int>(keypoint.pixel.y()) / kCellPx, 0, grid_rows_ - 1);
    return static_cast<std::size_t>(row * grid_cols_ + col);
  };
  cell_begin_.assign(static_cast<std::size_t>(grid_cols_ * grid_rows_) + 1, 0);
  for (const Keypoint& keypoint : keypoints) ++cell_begin_[cell_of(keypoint) + 1];
  for (std::size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
  cell_items_.resize(keypoints.size());
  std::vector<int> next(cell_begin_.begin(), cell_begin_.end() - 1);
  for (int i = 0; i < size(); ++i) {
    const Keypoint& keypoint = keypoints[static_cast<std::size_t>(i)];
    cell_items_[static_cast<std::size_t>(next[cell_of(keypoint)]++)] = {
        keypoint.pixel.x(), keypoint.pixel.y(), keypoint.octave, i};
  }
}

void Features::find_in_area(const Eigen::Vector2d& pixel, double radius_px, int min_octave,
                            int max_octave, std::vector<int>& found) const {
  // Keypoints outside the image (a lens can put them there) were clamped into the border cells, so
  // the look-up is clamped alike.
  const auto cell = [](double value, int cells) {
    return std::clamp(static_cast<int>(std::floor(value / kCellPx)), 0, cells - 1);
  };
  const int col_begin = cell(pixel.x() - radius_px, grid_cols_);
  const int col_end = cell(pixel.x() + radius_px, grid_cols_);
  const int row_begin = cell(pixel.y() - radius_px, grid_rows_);
  const int row_end = cell(pixel.y() + radius_px, grid_rows_);
  for (int row = row_begin; row <= row_end; ++row) {
    for (int col = col_begin; col <= col_end; ++col) {
      const auto index = static_cast<std::size_t>(row * grid_cols_ + col);
      for (int k = cell_begin_[index]; k < cell_begin_[index + 1]; ++k) {
        const CellItem& item = cell_items_[static_cast<std::size_t>(k)];
        if (item.octave < min_octave || item.octave > max_octave) continue;
        if (std::abs(item.x - pixel.x()) > radius_px || std::abs(item.y - pixel.y()) > radius_px) {
          continue;
        }
        found.push_back(item.keypoint);
      }
    }
  }
}

double ScaleLevels::scale(int octave) const {
  double scale = 1.0;
  for (int i = 0; i < octave; ++i) scale *= factor;
  return scale;
}

}  // namespace planecast::slam
