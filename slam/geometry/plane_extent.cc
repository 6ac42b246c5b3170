#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/geometry/plane_geometry.h"
#include "slam/geometry/point_clusters.h"

namespace planecast::slam {

namespace {

using Ring = std::vector<Eigen::Vector2d>;

constexpr double kCellsPerSpacing = 4.0;
/// Radius of the disc that closes gaps, in spacings. Of evenly strewn points hardly a void is
/// larger.
constexpr double kReach = 1.2;
/// How far the outline lies outside the outermost points, in spacings.
constexpr double kPadding = 0.3;
/// Smallest hole that is kept, side in spacings.
constexpr double kMinHole = 2.0;
constexpr int kMostCells = 600;

/// Occupancy in the plane's frame: cell (row, col) is centred at low + cell * (col, row).
struct Grid {
  cv::Mat occupied;
  Eigen::Vector2d low;
  double cell = 0.0;

  Eigen::Vector2d position(const cv::Point& p) const {
    return low + cell * Eigen::Vector2d(p.x, p.y);
  }
};

Ring to_plane(const Plane& plane, const std::vector<Eigen::Vector3d>& points, double link) {
  Ring result;
  std::vector<Eigen::Vector3d> flat;
  const Pose plane_from_world = plane.world_from_plane().inverse();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d q = plane_from_world * p;
    flat.emplace_back(q.x(), q.y(), 0.0);
  }
  const std::vector<int> cluster = cluster_points(flat, link);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (cluster[i] == 0) result.push_back(flat[i].head<2>());
  }
  return result;
}

Grid make_grid(const Ring& points, double spacing) {
  Eigen::Vector2d low = points.front();
  Eigen::Vector2d high = points.front();
  for (const Eigen::Vector2d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double border = (kReach + 1.0) * spacing;
  Grid grid;
  grid.low = low.array() - border;
  const Eigen::Vector2d size = (high - low).array() + 2.0 * border;
  grid.cell = std::max(spacing / kCellsPerSpacing, size.maxCoeff() / kMostCells);
  grid.occupied = cv::Mat::zeros(static_cast<int>(size.y() / grid.cell) + 1,
                                 static_cast<int>(size.x() / grid.cell) + 1, CV_8U);
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d at = (p - grid.low) / grid.cell;
    grid.occupied.at<uchar>(static_cast<int>(std::lround(at.y())),
                            static_cast<int>(std::lround(at.x()))) = 255;
  }
  return grid;
}

cv::Mat disc(double radius_cells) {
  const int r = std::max(1, static_cast<int>(std::lround(radius_cells)));
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1});
}

void close_gaps(Grid& grid, double spacing) {
  cv::dilate(grid.occupied, grid.occupied, disc(kReach * spacing / grid.cell));
  cv::erode(grid.occupied, grid.occupied, disc((kReach - kPadding) * spacing / grid.cell));
}

Ring simplified(const Grid& grid, const std::vector<cv::Point>& contour) {
  std::vector<cv::Point> kept;
  cv::approxPolyDP(contour, kept, 1.0, true);
  Ring ring;
  for (const cv::Point& p : kept) ring.push_back(grid.position(p));
  return ring;
}

std::vector<Eigen::Vector3d> to_world(const Plane& plane, Ring ring, bool counter_clockwise) {
  if ((signed_area(ring) > 0.0) != counter_clockwise) std::reverse(ring.begin(), ring.end());
  std::vector<Eigen::Vector3d> result;
  const Pose world_from_plane = plane.world_from_plane();
  for (const Eigen::Vector2d& p : ring) {
    result.push_back(world_from_plane * Eigen::Vector3d(p.x(), p.y(), 0.0));
  }
  return result;
}

int largest_outer(const std::vector<std::vector<cv::Point>>& contours,
                  const std::vector<cv::Vec4i>& hierarchy) {
  int best = -1;
  double best_area = -1.0;
  for (int i = 0; i < static_cast<int>(contours.size()); ++i) {
    if (hierarchy[i][3] >= 0) continue;
    const double area = cv::contourArea(contours[i]);
    if (area > best_area) {
      best_area = area;
      best = i;
    }
  }
  return best;
}

}  // namespace

PlaneExtent plane_extent(const Plane& plane, const std::vector<Eigen::Vector3d>& points,
                         double spacing) {
  PlaneExtent extent;
  if (points.size() < 3) return extent;
  if (!(spacing > 0.0)) spacing = typical_spacing(points);
  if (!(spacing > 0.0)) return extent;
  const Ring flat = to_plane(plane, points, 2.0 * kReach * spacing);
  if (flat.size() < 3) return extent;
  Grid grid = make_grid(flat, spacing);
  close_gaps(grid, spacing);

  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> hierarchy;
  cv::findContours(grid.occupied, contours, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  const int outer = largest_outer(contours, hierarchy);
  if (outer < 0) return extent;
  const Ring ring = simplified(grid, contours[outer]);
  if (ring.size() < 3) return extent;
  extent.outer = to_world(plane, ring, true);
  extent.area = std::abs(signed_area(ring));
  for (int i = hierarchy[outer][2]; i >= 0; i = hierarchy[i][0]) {
    const Ring hole = simplified(grid, contours[i]);
    const double area = std::abs(signed_area(hole));
    if (hole.size() < 3 || area < kMinHole * kMinHole * spacing * spacing) continue;
    extent.holes.push_back(to_world(plane, hole, false));
    extent.area -= area;
  }
  return extent;
}

}  // namespace planecast::slam
