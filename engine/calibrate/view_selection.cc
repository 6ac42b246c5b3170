#include "engine/calibrate/view_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>

namespace planecast::engine {
namespace {

constexpr int kGridColumns = 8;
constexpr int kGridRows = 6;

/// Centre, size, and the lopsidedness that a slant gives, all about 0 to 1.
using Shape = std::array<double, 5>;

/// Difference of the corners' spread in two halves of the board, as a share: seen from the front
/// both are the same. `axis` 0: left and right half, 1: upper and lower.
double lopsidedness(const BoardView& view, int axis) {
  const auto along = [axis](const cv::Point3f& corner) { return axis == 0 ? corner.x : corner.y; };
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  for (const cv::Point3f& corner : view.board) {
    low = std::min(low, along(corner));
    high = std::max(high, along(corner));
  }
  std::array<std::vector<cv::Point2f>, 2> halves;
  for (std::size_t i = 0; i < view.board.size(); ++i) {
    halves[along(view.board[i]) > 0.5F * (low + high) ? 1 : 0].push_back(view.image[i]);
  }
  if (halves[0].size() < 2 || halves[1].size() < 2) return 0.0;
  std::array<double, 2> spread{};
  for (std::size_t half = 0; half < 2; ++half) {
    const cv::RotatedRect box = cv::minAreaRect(halves[half]);
    spread[half] = std::max(box.size.width, box.size.height);
  }
  return (spread[1] - spread[0]) / std::max(spread[0] + spread[1], 1.0);
}

Shape shape_of(const BoardView& view, cv::Size size) {
  const cv::RotatedRect box = cv::minAreaRect(view.image);
  const double area = static_cast<double>(box.size.width) * box.size.height;
  return {box.center.x / size.width, box.center.y / size.height,
          std::sqrt(area / (static_cast<double>(size.width) * size.height)),
          2.0 * lopsidedness(view, 0), 2.0 * lopsidedness(view, 1)};
}

double distance(const Shape& a, const Shape& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace

std::vector<int> select_views(const std::vector<BoardView>& views, cv::Size image_size, int most) {
  const std::size_t count = std::min(views.size(), static_cast<std::size_t>(std::max(most, 0)));
  if (count == 0) return {};
  std::vector<Shape> shapes;
  for (const BoardView& view : views) shapes.push_back(shape_of(view, image_size));
  const auto largest = std::ranges::max_element(shapes, {}, [](const Shape& s) { return s[2]; });
  std::set<int> chosen = {static_cast<int>(largest - shapes.begin())};
  std::vector<double> to_chosen(shapes.size(), std::numeric_limits<double>::max());
  std::size_t last = static_cast<std::size_t>(*chosen.begin());
  while (chosen.size() < count) {
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      to_chosen[i] = std::min(to_chosen[i], distance(shapes[i], shapes[last]));
      if (chosen.contains(static_cast<int>(i))) to_chosen[i] = -1.0;
      if (to_chosen[i] > to_chosen[farthest]) farthest = i;
    }
    last = farthest;
    chosen.insert(static_cast<int>(last));
  }
  return {chosen.begin(), chosen.end()};
}

double corner_coverage(const std::vector<BoardView>& views, cv::Size image_size) {
  std::set<int> cells;
  for (const BoardView& view : views) {
    for (const cv::Point2f& corner : view.image) {
      const int col =
          static_cast<int>(corner.x * kGridColumns / static_cast<float>(image_size.width));
      const int row =
          static_cast<int>(corner.y * kGridRows / static_cast<float>(image_size.height));
      if (col < 0 || row < 0 || col >= kGridColumns || row >= kGridRows) continue;
      cells.insert(row * kGridColumns + col);
    }
  }
  return static_cast<double>(cells.size()) / (kGridColumns * kGridRows);
}

}  // namespace planecast::engine
