#include <ceres/loss_function.h>
#include <ceres/sphere_manifold.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "slam/geometry/depth_noise.h"
#include "slam/optimize/bundle.h"
#include "slam/optimize/bundle_problem.h"
#include "slam/optimize/depth_plane_cost.h"

namespace planecast::slam {
namespace {

/// Of the distance that holds a monocular map's scale, as a share of it.
constexpr double kScaleSigma = 1e-5;
constexpr double kMinScaleDistance = 1e-6;

struct PlaneBlock {
  PlaneId id = kNone;
  Eigen::Vector3d normal;
  double offset = 0.0;
};

struct Ownership {
  int point = 0;
  int plane = 0;
};

/// A depth point of a plane, in the camera of a living keyframe.
struct DepthSight {
  int pose = 0;
  int plane = 0;
  Eigen::Vector3d point_cam;
};

/// The strong planes, which points own them and which depth points support them. Without the
/// latter a plane with few landmarks would leave what its depth says.
struct PlaneProblem {
  std::vector<PlaneBlock> planes;
  std::vector<Ownership> owned;
  std::vector<DepthSight> sights;
};

void collect_depth(const Map& map, const BundleProblem& bundle, const Plane& plane, int index,
                   std::vector<DepthSight>& sights) {
  for (std::size_t i = 0; i < plane.depth_anchors.size(); ++i) {
    const DepthAnchor& anchor = plane.depth_anchors[i];
    const KeyframeId living = map.living_ancestor(anchor.keyframe);
    const auto found = std::lower_bound(bundle.keyframes.begin(), bundle.keyframes.end(), living);
    if (found == bundle.keyframes.end() || *found != living) continue;
    const Pose living_from_anchor =
        map.keyframes.at(living).cam_from_world * map.keyframe_pose(anchor.keyframe).inverse();
    sights.push_back({static_cast<int>(found - bundle.keyframes.begin()), index,
                      living_from_anchor * anchor.point_cam.cast<double>()});
  }
}

PlaneProblem collect_planes(const Map& map, const BundleProblem& bundle) {
  PlaneProblem problem;
  std::vector<int> index(static_cast<std::size_t>(map.planes.next_id()), kNone);
  for (const Plane& plane : map.planes) {
    if (plane.weak) continue;
    index[static_cast<std::size_t>(plane.id)] = static_cast<int>(problem.planes.size());
    problem.planes.push_back({plane.id, plane.normal.normalized(), plane.offset});
    // Depth of pairs of keyframes says nothing that their poses do not.
    if (!bundle.has_depth()) continue;
    collect_depth(map, bundle, plane, static_cast<int>(problem.planes.size()) - 1, problem.sights);
  }
  for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
    const PlaneId id = map.landmarks.at(bundle.landmarks[i]).plane;
    if (!map.planes.contains(id) || !bundle.points[i].allFinite()) continue;
    const int plane = index[static_cast<std::size_t>(id)];
    if (plane != kNone) problem.owned.push_back({static_cast<int>(i), plane});
  }
  return problem;
}

double signed_distance(const PlaneProblem& planes, const BundleProblem& bundle,
                       const Ownership& owned) {
  const PlaneBlock& plane = planes.planes[static_cast<std::size_t>(owned.plane)];
  return plane.normal.dot(bundle.points[static_cast<std::size_t>(owned.point)]) + plane.offset;
}

/// Root mean square distance of the owned points of plane `plane`, or of all planes.
double plane_rms(const PlaneProblem& planes, const BundleProblem& bundle,
                 std::optional<int> plane = std::nullopt) {
  double sum = 0.0;
  int count = 0;
  for (const Ownership& owned : planes.owned) {
    if (plane && owned.plane != *plane) continue;
    const double distance = signed_distance(planes, bundle, owned);
    sum += distance * distance;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

/// Without depth the plane residuals would shrink with the map, at no cost in reprojection. Holds
/// the distance between the first keyframe and the one farthest from it.
std::unique_ptr<CentreDistanceCost> scale_cost(const BundleProblem& bundle, int& keyframe) {
  keyframe = kNone;
  double farthest = kMinScaleDistance;
  if (bundle.has_depth()) return nullptr;
  for (int i = 1; i < static_cast<int>(bundle.poses.size()); ++i) {
    const double distance = keyframe_distance(bundle, 0, i);
    if (distance <= farthest) continue;
    farthest = distance;
    keyframe = i;
  }
  if (keyframe == kNone) return nullptr;
  const Eigen::Vector3d anchor = pose_from_block(bundle.poses.front()).inverse().translation();
  return std::make_unique<CentreDistanceCost>(anchor, farthest, kScaleSigma * farthest);
}

void solve_jointly(BundleProblem& bundle, PlaneProblem& planes, double plane_sigma,
                   BundleSolve solve) {
  PointPlaneCost cost(plane_sigma);
  std::deque<DepthPlaneCost> depth_costs;
  ceres::CauchyLoss cauchy(1.0);
  ceres::SphereManifold<3> sphere;
  int scale_keyframe = kNone;
  const std::unique_ptr<CentreDistanceCost> scale = scale_cost(bundle, scale_keyframe);
  solve.extend = [&](ceres::Problem& problem, ceres::ParameterBlockOrdering& ordering) {
    std::vector<char> used(planes.planes.size(), 0);
    for (const Ownership& owned : planes.owned) {
      PlaneBlock& plane = planes.planes[static_cast<std::size_t>(owned.plane)];
      double* point = bundle.points[static_cast<std::size_t>(owned.point)].data();
      if (!problem.HasParameterBlock(point)) continue;
      problem.AddResidualBlock(&cost, &cauchy, point, plane.normal.data(), &plane.offset);
      used[static_cast<std::size_t>(owned.plane)] = 1;
    }
    for (const DepthSight& sight : planes.sights) {
      PlaneBlock& plane = planes.planes[static_cast<std::size_t>(sight.plane)];
      double* pose = bundle.poses[static_cast<std::size_t>(sight.pose)].data();
      if (!problem.HasParameterBlock(pose)) continue;
      depth_costs.emplace_back(sight.point_cam,
                               std::max(plane_sigma, depth_sigma_m(sight.point_cam.z())));
      problem.AddResidualBlock(&depth_costs.back(), &cauchy, pose, plane.normal.data(),
                               &plane.offset);
      used[static_cast<std::size_t>(sight.plane)] = 1;
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (!used[i]) continue;
      problem.SetManifold(planes.planes[i].normal.data(), &sphere);
      ordering.AddElementToGroup(planes.planes[i].normal.data(), kPlaneGroup);
      ordering.AddElementToGroup(&planes.planes[i].offset, kPlaneGroup);
    }
    if (scale == nullptr) return;
    double* pose = bundle.poses[static_cast<std::size_t>(scale_keyframe)].data();
    if (problem.HasParameterBlock(pose)) problem.AddResidualBlock(scale.get(), nullptr, pose);
  };
  solve_bundle(bundle, solve);
}

void write_back_planes(const PlaneProblem& planes, const BundleProblem& bundle, Map& map) {
  for (int i = 0; i < static_cast<int>(planes.planes.size()); ++i) {
    const PlaneBlock& block = planes.planes[static_cast<std::size_t>(i)];
    Plane& plane = map.planes.at(block.id);
    plane.refit(block.normal.normalized(), block.offset);
    plane.rms = plane_rms(planes, bundle, i);
    for (std::size_t k = 0; k < plane.depth_points.size(); ++k) {
      const DepthAnchor& anchor = plane.depth_anchors[k];
      plane.depth_points[k] =
          map.keyframe_pose(anchor.keyframe).inverse() * anchor.point_cam.cast<double>();
    }
  }
}

}  // namespace

JointResult refine_jointly(Map& map, const Camera& camera, const JointOptions& options) {
  JointResult result;
  if (map.keyframes.empty()) return result;
  BundleProblem start = collect_whole_map(map, camera, options.bundle);
  const PlaneProblem start_planes = collect_planes(map, start);
  deactivate_outliers(start, std::numeric_limits<double>::infinity());
  BundleSolve solve;
  solve.iterations = options.bundle.iterations;
  solve.loss = RobustLoss::kCauchy;
  solve.spread = measure_spread(start);
  result.reprojection_cost_before = result.reprojection_cost_after = loss_of(start, solve);
  result.plane_rms_before = result.plane_rms_after = plane_rms(start_planes, start);
  result.plane_sigma = options.plane_sigma;
  if (start_planes.owned.empty()) return result;

  const double limit = (1.0 + options.max_reprojection_rise) * result.reprojection_cost_before;
  for (int relaxation = 0; relaxation <= options.max_relaxations; ++relaxation) {
    result.plane_sigma = std::ldexp(options.plane_sigma, relaxation);
    BundleProblem bundle = start;
    PlaneProblem planes = start_planes;
    solve_jointly(bundle, planes, result.plane_sigma, solve);
    result.reprojection_cost_after = loss_of(bundle, solve);
    result.plane_rms_after = plane_rms(planes, bundle);
    if (!(result.reprojection_cost_after <= limit)) continue;
    result.kept = true;
    write_back(bundle, map);
    write_back_planes(planes, bundle, map);
    break;
  }
  return result;
}

}  // namespace planecast::slam
