#include "slam/stages/plane_plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "slam/geometry/point_clusters.h"

namespace planecast::slam {

namespace {

std::vector<char> marks_of(const KeyframePoints& shown, const PlaneCandidate& candidate) {
  std::vector<char> marks(static_cast<std::size_t>(shown.size()), 0);
  for (const int i : candidate.inliers) marks[i] = 1;
  return marks;
}

std::vector<Eigen::Vector3d> positions_of(const KeyframePoints& shown,
                                          const PlaneCandidate& candidate) {
  std::vector<Eigen::Vector3d> result;
  result.reserve(candidate.inliers.size());
  for (const int i : candidate.inliers) result.push_back(shown.points.positions[i]);
  return result;
}

/// Standard deviations along the longer and the shorter side in the plane.
Eigen::Vector2d spread_of(const std::vector<Eigen::Vector3d>& points, const PlaneEquation& plane) {
  Plane frame;
  frame.refit(plane.normal, plane.offset);
  const Pose plane_from_world = frame.world_from_plane().inverse();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector2d at = (plane_from_world * p).head<2>();
    mean += at;
    square += at * at.transpose();
  }
  const double n = static_cast<double>(points.size());
  mean /= n;
  const Eigen::Matrix2d covariance = square / n - mean * mean.transpose();
  const double half_trace = 0.5 * covariance.trace();
  const double root = std::sqrt(std::max(half_trace * half_trace - covariance.determinant(), 0.0));
  return {std::sqrt(half_trace + root), std::sqrt(std::max(half_trace - root, 0.0))};
}

bool may_rival(const Map& map, PlaneId owner, const PlaneCandidate& candidate) {
  if (owner == kNone) return true;
  constexpr double kNearlyParallel = 0.9;
  return map.planes.at(owner).normal.dot(candidate.plane.normal) > kNearlyParallel;
}

}  // namespace

int marked_neighbours(const KeyframePoints& shown, const std::vector<char>& marks, int i) {
  int count = 0;
  const std::size_t row =
      static_cast<std::size_t>(i) * static_cast<std::size_t>(shown.nearest.count);
  for (std::size_t k = 0; k < kCoherenceNeighbours; ++k) {
    const int other = shown.nearest.index[row + k];
    count += other >= 0 && marks[other];
  }
  return count;
}

double coherence(const KeyframePoints& shown, const PlaneCandidate& candidate) {
  if (candidate.inliers.empty()) return 0.0;
  const std::vector<char> marks = marks_of(shown, candidate);
  double sum = 0.0;
  for (const int i : candidate.inliers) sum += marked_neighbours(shown, marks, i);
  return sum / (static_cast<double>(candidate.inliers.size()) * kCoherenceNeighbours);
}

void keep_coherent(const KeyframePoints& shown, const PlausibilityOptions& options,
                   PlaneCandidate& candidate) {
  const std::vector<char> marks = marks_of(shown, candidate);
  std::vector<int> kept;
  for (const int i : candidate.inliers) {
    if (marked_neighbours(shown, marks, i) >= options.min_coherent_neighbours) kept.push_back(i);
  }
  candidate.inliers = std::move(kept);
}

void keep_connected(const KeyframePoints& shown, const PlaneScale& scale,
                    PlaneCandidate& candidate) {
  if (candidate.inliers.empty()) return;
  const std::vector<Eigen::Vector3d> points = positions_of(shown, candidate);
  const std::vector<int> cluster = cluster_points(points, link_of(points, scale));
  std::vector<int> kept;
  for (std::size_t i = 0; i < cluster.size(); ++i) {
    if (cluster[i] == 0) kept.push_back(candidate.inliers[i]);
  }
  candidate.inliers = std::move(kept);
}

bool is_broad(const KeyframePoints& shown, const PlaneCandidate& candidate,
              const PlausibilityOptions& options) {
  double view = 0.0;
  for (const int i : candidate.inliers)
    view += shown.points.view_from[i].dot(candidate.plane.normal);
  const Eigen::Vector2d spread = spread_of(positions_of(shown, candidate), candidate.plane);
  return view > options.min_view_cosine * static_cast<double>(candidate.inliers.size()) &&
         spread.y() > options.min_breadth * candidate.eps &&
         spread.y() > options.min_slimness * spread.x();
}

double contrast(const Map& map, const KeyframePoints& shown, const PlaneCandidate& candidate,
                const PlaneScale& scale) {
  const std::vector<Eigen::Vector3d> patch = positions_of(shown, candidate);
  const double link = link_of(patch, scale);
  const std::vector<char> is_inlier = marks_of(shown, candidate);
  const int label = candidate.inliers.empty() ? 0 : shown.label[candidate.inliers.front()];
  int beside = 0;
  for (int i = 0; i < shown.size(); ++i) {
    if (is_inlier[i] || !may_rival(map, shown.plane[i], candidate)) continue;
    if (shown.has_masks && shown.label[i] != label) continue;
    const double distance = candidate.plane.signed_distance(shown.points.positions[i]);
    const double bands = std::abs(distance) / (shown.points.band[i] * candidate.eps);
    if (bands > 3.0 || bands < 1.0) continue;
    const Eigen::Vector3d foot = shown.points.positions[i] - distance * candidate.plane.normal;
    beside += std::any_of(patch.begin(), patch.end(), [&](const Eigen::Vector3d& p) {
      return (p - foot).squaredNorm() < link * link;
    });
  }
  // The space beside is twice as thick as the band.
  return beside == 0 ? HUGE_VAL : static_cast<double>(patch.size()) / (0.5 * beside);
}

}  // namespace planecast::slam
