#include "slam/stages/plane_plausibility.h"

#include <Eigen/Geometry>
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

struct Neighbours {
  int asked = 0;
  int marked = 0;
  double share() const { return asked == 0 ? 0.0 : static_cast<double>(marked) / asked; }
};

Neighbours neighbours_of(const KeyframePoints& shown, const PlaneCandidate& candidate,
                         const std::vector<char>& marks, int i) {
  Neighbours result;
  const std::size_t row =
      static_cast<std::size_t>(i) * static_cast<std::size_t>(shown.nearest.count);
  for (std::size_t k = 0; k < kCoherenceNeighbours; ++k) {
    const int other = shown.nearest.index[row + k];
    if (other < 0) continue;
    const bool asked = !shown.has_normals || (!shown.normal[other].isZero() &&
                                              shown.may_face(other, candidate.plane.normal));
    result.asked += asked;
    result.marked += asked && marks[other];
  }
  return result;
}

bool may_rival(const Map& map, PlaneId owner, const PlaneCandidate& candidate) {
  if (owner == kNone) return true;
  constexpr double kNearlyParallel = 0.9;
  return map.planes.at(owner).normal.dot(candidate.plane.normal) > kNearlyParallel;
}

}  // namespace

double coherence(const KeyframePoints& shown, const PlaneCandidate& candidate) {
  const std::vector<char> marks = marks_of(shown, candidate);
  Neighbours sum;
  for (const int i : candidate.inliers) {
    const Neighbours own = neighbours_of(shown, candidate, marks, i);
    sum.asked += own.asked;
    sum.marked += own.marked;
  }
  return sum.share();
}

void keep_coherent(const KeyframePoints& shown, const PlausibilityOptions& options,
                   PlaneCandidate& candidate) {
  const std::vector<char> marks = marks_of(shown, candidate);
  std::vector<int> kept;
  for (const int i : candidate.inliers) {
    if (neighbours_of(shown, candidate, marks, i).share() > options.min_own_coherence) {
      kept.push_back(i);
    }
  }
  candidate.inliers = std::move(kept);
}

void keep_connected(const KeyframePoints& shown, const PlaneScale& scale,
                    PlaneCandidate& candidate) {
  constexpr int kMinPatch = 3;
  if (candidate.inliers.empty()) return;
  const std::vector<Eigen::Vector3d> points = positions_of(shown, candidate);
  const double link = shown.has_masks ? link_in_mask(points, scale) : link_of(points, scale);
  const std::vector<int> cluster = cluster_points(points, link);
  std::vector<int> size(cluster.size(), 0);
  for (const int c : cluster) ++size[c];
  std::vector<int> kept;
  for (std::size_t i = 0; i < cluster.size(); ++i) {
    const bool joined = cluster[i] == 0 || (shown.has_masks && size[cluster[i]] >= kMinPatch);
    if (joined) kept.push_back(candidate.inliers[i]);
  }
  candidate.inliers = std::move(kept);
}

bool is_faced(const KeyframePoints& shown, const PlaneCandidate& candidate, const PlaneScale& scale,
              const PlausibilityOptions& options) {
  if (!shown.has_normals) return true;
  Eigen::AlignedBox3d box;
  for (const int i : candidate.inliers) box.extend(shown.points.positions[i]);
  int known = 0;
  int facing = 0;
  for (int i = 0; i < shown.size(); ++i) {
    if (shown.plane[i] != kNone || shown.normal[i].isZero()) continue;
    if (candidate.label > 0 && shown.label[i] != candidate.label) continue;
    const Eigen::Vector3d& point = shown.points.positions[i];
    const double distance = std::abs(candidate.plane.signed_distance(point));
    if (distance > shown.points.band[i] * candidate.eps || !box.contains(point)) continue;
    ++known;
    facing += shown.may_face(i, candidate.plane.normal);
  }
  const bool thick = candidate.label > 0 && !is_sharp(candidate.eps, scale);
  const double inliers = static_cast<double>(candidate.inliers.size());
  return facing >= options.min_facing * known &&
         (!thick || facing >= options.min_facing_of_thick * inliers);
}

SeenThrough count_seen_through(const PlaneEquation& plane, const PlanePoints& points, double eps,
                               const PlaneScale& scale) {
  constexpr double kDeepest = 4.0;          // bands
  constexpr double kLeastCosine = 0.2;      // flatter rays cross the plane somewhere else
  constexpr int kAbout = 2;                 // points on the plane that the ray passes between...
  const double nearby = 2.0 * scale.eps_d;  // ...within so much
  const auto distance_of = [&](int i) {
    return plane.signed_distance(points.positions[static_cast<std::size_t>(i)]) /
           points.band[static_cast<std::size_t>(i)];
  };
  std::vector<Eigen::Vector3d> on_plane;
  for (int i = 0; i < points.size(); ++i) {
    if (std::abs(distance_of(i)) < eps)
      on_plane.push_back(points.positions[static_cast<std::size_t>(i)]);
  }
  SeenThrough result{static_cast<int>(on_plane.size()), 0};
  for (int i = 0; i < points.size(); ++i) {
    const double distance = distance_of(i);
    const Eigen::Vector3d& ray = points.view_from[static_cast<std::size_t>(i)];
    const double cosine = ray.dot(plane.normal);
    if (distance > -eps || distance < -kDeepest * eps || cosine < kLeastCosine) continue;
    const Eigen::Vector3d& point = points.positions[static_cast<std::size_t>(i)];
    const Eigen::Vector3d crossing = point - plane.signed_distance(point) / cosine * ray;
    const auto about =
        std::count_if(on_plane.begin(), on_plane.end(),
                      [&](const Eigen::Vector3d& p) { return (p - crossing).norm() < nearby; });
    result.through += about >= kAbout;
  }
  return result;
}

bool is_broad(const KeyframePoints& shown, const PlaneCandidate& candidate,
              const PlausibilityOptions& options) {
  double view = 0.0;
  for (const int i : candidate.inliers)
    view += shown.points.view_from[i].dot(candidate.plane.normal);
  const double breadth = candidate.label > 0 ? options.min_breadth_in_mask : options.min_breadth;
  const Eigen::Vector2d spread = spread_of(positions_of(shown, candidate), candidate.plane);
  return view > options.min_view_cosine * static_cast<double>(candidate.inliers.size()) &&
         spread.y() > breadth * candidate.eps && spread.y() > options.min_slimness * spread.x();
}

double contrast(const Map& map, const KeyframePoints& shown, const PlaneCandidate& candidate,
                const PlaneScale& scale) {
  const std::vector<Eigen::Vector3d> patch = positions_of(shown, candidate);
  const double link = link_of(patch, scale);
  const std::vector<char> is_inlier = marks_of(shown, candidate);
  int beside = 0;
  for (int i = 0; i < shown.size(); ++i) {
    if (is_inlier[i] || !may_rival(map, shown.plane[i], candidate)) continue;
    if (!shown.may_face(i, candidate.plane.normal)) continue;
    if (shown.has_masks && shown.label[i] != candidate.label) continue;
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
