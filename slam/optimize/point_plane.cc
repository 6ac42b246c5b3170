#include <ceres/loss_function.h>
#include <ceres/sphere_manifold.h>

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "slam/optimize/bundle.h"
#include "slam/optimize/bundle_problem.h"

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

/// The strong planes and which points own them.
struct PlaneProblem {
  std::vector<PlaneBlock> planes;
  std::vector<Ownership> owned;
};

PlaneProblem collect_planes(const Map& map, const BundleProblem& bundle) {
  PlaneProblem problem;
  std::vector<int> index(static_cast<std::size_t>(map.planes.next_id()), kNone);
  for (const Plane& plane : map.planes) {
    if (plane.weak) continue;
    index[static_cast<std::size_t>(plane.id)] = static_cast<int>(problem.planes.size());
    problem.planes.push_back({plane.id, plane.normal.normalized(), plane.offset});
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

double huber_cost(const BundleProblem& bundle) {
  double sum = 0.0;
  for (const BundleObservation& seen : bundle.observations) {
    if (!seen.active) continue;
    const double chi2 = bundle.chi2(seen);
    const double threshold = bundle.threshold(seen);
    sum += chi2 <= threshold ? chi2 : 2.0 * std::sqrt(chi2 * threshold) - threshold;
  }
  return sum;
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
                   int iterations) {
  PointPlaneCost cost(plane_sigma);
  ceres::CauchyLoss cauchy(1.0);
  ceres::SphereManifold<3> sphere;
  int scale_keyframe = kNone;
  const std::unique_ptr<CentreDistanceCost> scale = scale_cost(bundle, scale_keyframe);
  BundleSolve solve;
  solve.iterations = iterations;
  solve.extend = [&](ceres::Problem& problem, ceres::ParameterBlockOrdering& ordering) {
    std::vector<char> used(planes.planes.size(), 0);
    for (const Ownership& owned : planes.owned) {
      PlaneBlock& plane = planes.planes[static_cast<std::size_t>(owned.plane)];
      double* point = bundle.points[static_cast<std::size_t>(owned.point)].data();
      if (!problem.HasParameterBlock(point)) continue;
      problem.AddResidualBlock(&cost, &cauchy, point, plane.normal.data(), &plane.offset);
      used[static_cast<std::size_t>(owned.plane)] = 1;
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
  }
}

}  // namespace

JointResult refine_jointly(Map& map, const Camera& camera, const JointOptions& options) {
  JointResult result;
  if (map.keyframes.empty()) return result;
  BundleProblem start = collect_whole_map(map, camera, options.bundle);
  const PlaneProblem start_planes = collect_planes(map, start);
  deactivate_outliers(start, std::numeric_limits<double>::infinity());
  result.reprojection_cost_before = result.reprojection_cost_after = huber_cost(start);
  result.plane_rms_before = result.plane_rms_after = plane_rms(start_planes, start);
  result.plane_sigma = options.plane_sigma;
  if (start_planes.owned.empty()) return result;

  const double limit = (1.0 + options.max_reprojection_rise) * result.reprojection_cost_before;
  for (int relaxation = 0; relaxation <= options.max_relaxations; ++relaxation) {
    result.plane_sigma = std::ldexp(options.plane_sigma, relaxation);
    BundleProblem bundle = start;
    PlaneProblem planes = start_planes;
    solve_jointly(bundle, planes, result.plane_sigma, options.bundle.iterations);
    result.reprojection_cost_after = huber_cost(bundle);
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
