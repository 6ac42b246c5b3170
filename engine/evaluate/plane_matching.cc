#include "engine/evaluate/plane_matching.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "engine/evaluate/partition.h"

namespace planecast::engine {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
/// Nearer points do not count as seen.
constexpr double kNearest_m = 0.05;
/// Poses tried for visibility are spread over the run: neighbours see the same.
constexpr std::size_t kMaxViews = 200;
constexpr int kViewGrid = 16;

std::vector<Eigen::Vector3d> support_of(const PlaneRecord& plane, const Patch& patch,
                                        const std::vector<MapPoint>& points, int grid_cells) {
  if (patch.area() > 0.0) return patch.grid(grid_cells);
  std::vector<Eigen::Vector3d> support;
  for (const MapPoint& point : points) {
    if (point.plane == plane.id) support.push_back(point.position);
  }
  return support;
}

PlaneRelation relate(const PlaneRecord& estimate, const std::vector<Eigen::Vector3d>& support,
                     double area, const PlaneRecord& truth, const Patch& true_patch) {
  PlaneRelation relation;
  relation.angle_deg = kDegrees * std::atan2(estimate.normal.cross(truth.normal).norm(),
                                             estimate.normal.dot(truth.normal));
  relation.offset_m = estimate.normal.dot(true_patch.centroid()) + estimate.offset;
  if (support.empty()) return relation;
  const auto inside = std::count_if(
      support.begin(), support.end(),
      [&true_patch](const Eigen::Vector3d& point) { return true_patch.contains(point); });
  const double share = static_cast<double>(inside) / static_cast<double>(support.size());
  relation.common_area_m2 = share * area;
  relation.overlap = share;
  if (true_patch.area() > 0.0) {
    relation.coverage = std::min(1.0, relation.common_area_m2 / true_patch.area());
    relation.overlap = std::max(relation.overlap, relation.coverage);
  }
  return relation;
}

}  // namespace

bool PlaneRelation::within(const PlaneTolerance& tolerance, double min_overlap) const {
  return angle_deg <= tolerance.angle_deg && std::abs(offset_m) <= tolerance.offset_m &&
         overlap >= min_overlap;
}

RelationTable relate_planes(const std::vector<PlaneRecord>& estimated,
                            const std::vector<MapPoint>& points,
                            const std::vector<PlaneRecord>& truth, int grid_cells) {
  const std::vector<Patch> true_patches(truth.begin(), truth.end());
  RelationTable table;
  for (const PlaneRecord& plane : estimated) {
    const Patch patch(plane);
    const std::vector<Eigen::Vector3d> support = support_of(plane, patch, points, grid_cells);
    std::vector<PlaneRelation>& row = table.emplace_back();
    for (std::size_t t = 0; t < truth.size(); ++t) {
      row.push_back(relate(plane, support, patch.area(), truth[t], true_patches[t]));
    }
  }
  return table;
}

std::vector<int> match_planes(const RelationTable& relations, std::size_t num_truth,
                              const PlaneTolerance& tolerance, double min_overlap) {
  // Larger common area first, then larger overlap (for planes without polygon), then lower indices.
  std::vector<std::tuple<double, double, int, int>> candidates;
  for (std::size_t e = 0; e < relations.size(); ++e) {
    for (std::size_t t = 0; t < num_truth; ++t) {
      const PlaneRelation& relation = relations[e][t];
      if (!relation.within(tolerance, min_overlap)) continue;
      candidates.emplace_back(-relation.common_area_m2, -relation.overlap, static_cast<int>(e),
                              static_cast<int>(t));
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<int> truth_of(relations.size(), -1);
  std::vector<char> taken(num_truth, 0);
  for (const auto& [area, overlap, e, t] : candidates) {
    int& match = truth_of[static_cast<std::size_t>(e)];
    if (match >= 0 || taken[static_cast<std::size_t>(t)] != 0) continue;
    match = t;
    taken[static_cast<std::size_t>(t)] = 1;
  }
  return truth_of;
}

bool is_in_view(const slam::Pose& world_from_cam, const slam::Camera& camera,
                const Eigen::Vector3d& point) {
  const Eigen::Vector3d in_camera = world_from_cam.inverse() * point;
  return in_camera.z() > kNearest_m && camera.contains(camera.project(in_camera));
}

std::vector<char> planes_in_view(const std::vector<PlaneRecord>& truth,
                                 const std::vector<TimedPose>& poses, const slam::Camera& camera,
                                 double min_share) {
  const std::size_t step = std::max<std::size_t>(1, poses.size() / kMaxViews);
  std::vector<char> in_view;
  for (const PlaneRecord& plane : truth) {
    const std::vector<Eigen::Vector3d> samples = Patch(plane).grid(kViewGrid);
    const auto is_seen = [&](const Eigen::Vector3d& sample) {
      for (std::size_t i = 0; i < poses.size(); i += step) {
        const slam::Pose& pose = poses[i].world_from_cam;
        const bool from_front = plane.normal.dot(pose.translation()) + plane.offset > 0.0;
        if (from_front && is_in_view(pose, camera, sample)) return true;
      }
      return false;
    };
    const auto seen = std::count_if(samples.begin(), samples.end(), is_seen);
    const double needed = min_share * static_cast<double>(samples.size());
    in_view.push_back(seen > 0 && static_cast<double>(seen) >= needed ? 1 : 0);
  }
  return in_view;
}

PointLabelScore score_point_labels(const std::vector<MapPoint>& points,
                                   const std::vector<int>& truth_of_point) {
  LabelPairs pairs;
  for (std::size_t i = 0; i < points.size(); ++i) ++pairs[{truth_of_point[i], points[i].plane}];
  const PartitionScore partition = score_partition(pairs);
  return {static_cast<int>(points.size()), partition.rand_index, partition.variation_of_information,
          partition.segmentation_covering};
}

}  // namespace planecast::engine
