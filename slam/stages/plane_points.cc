#include "slam/stages/plane_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "slam/geometry/depth_noise.h"

namespace planecast::slam {

namespace {

constexpr double kMaxBand = 2.5;
/// Of own_eps: the least, in eps_d, and its standard deviations.
constexpr double kTightest = 0.35;
constexpr double kSigmas = 3.0;
/// Of strong_inliers, where no mask speaks for a plane; with samples of the depth among them.
constexpr double kUnmasked = 2.0;
constexpr double kUnmaskedDepth = 3.0;
/// Of strong_inliers, for planes of stereo depth with or without a mask: where it is wrong it is
/// wrong alike over a patch of the image.
constexpr double kStereo = 3.0;

}  // namespace

double depth_sigma(const PlaneContext& context, double z) {
  return context.metre * depth_sigma_m(z / context.metre);
}

double band_of(const PlaneContext& context, double z) {
  if (!context.rgbd || !(context.scale.eps_d > 0.0)) return 1.0;
  return std::clamp(3.0 * depth_sigma(context, z) / context.scale.eps_d, 1.0, kMaxBand);
}

double band_of_landmark(const Map& map, const Landmark& landmark, const PlaneContext& context) {
  constexpr double kNearest_m = 0.4;
  const Keyframe* first = landmark.observations.empty()
                              ? nullptr
                              : map.keyframes.find(landmark.observations.front().keyframe);
  const double z = first == nullptr ? 0.0 : (first->cam_from_world * landmark.position).z();
  return band_of(context, std::max(z, kNearest_m * context.metre));
}

bool is_too_vague(const PlaneContext& context, double z) {
  return 3.0 * depth_sigma(context, z) > kMaxBand * context.scale.eps_d;
}

std::vector<PlaneSupport> gather_support(const Map& map, const PlaneContext& context) {
  std::vector<PlaneSupport> result(static_cast<std::size_t>(map.planes.next_id()));
  for (const Landmark& landmark : map.landmarks) {
    if (!map.planes.contains(landmark.plane)) continue;
    PlaneSupport& support = result[static_cast<std::size_t>(landmark.plane)];
    support.landmarks.push_back(landmark.id);
    support.points.positions.push_back(landmark.position);
    support.points.view_from.push_back(landmark.view_from);
    support.points.band.push_back(band_of_landmark(map, landmark, context));
  }
  std::vector<std::optional<Eigen::Vector3d>> centres(
      static_cast<std::size_t>(map.keyframes.next_id()));
  for (const Plane& plane : map.planes) {
    PlanePoints& points = result[static_cast<std::size_t>(plane.id)].points;
    for (std::size_t i = 0; i < plane.depth_points.size(); ++i) {
      const DepthAnchor& anchor = plane.depth_anchors[i];
      std::optional<Eigen::Vector3d>& centre = centres[static_cast<std::size_t>(anchor.keyframe)];
      if (!centre) centre = map.keyframe_pose(anchor.keyframe).inverse().translation();
      points.positions.push_back(plane.depth_points[i]);
      points.view_from.push_back((*centre - plane.depth_points[i]).normalized());
      points.band.push_back(band_of(context, anchor.point_cam.z()));
    }
  }
  return result;
}

double own_eps(const PlaneEquation& plane, const PlanePoints& support, const PlaneScale& scale) {
  constexpr double kSigmaOfMedian = 1.4826;  // normal distribution
  if (support.positions.empty()) return scale.eps_d;
  std::vector<double> distance;
  distance.reserve(support.positions.size());
  for (int i = 0; i < support.size(); ++i) {
    distance.push_back(std::abs(plane.signed_distance(support.positions[i])) / support.band[i]);
  }
  const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
  std::nth_element(distance.begin(), middle, distance.end());
  return eps_of_sigma(kSigmaOfMedian * *middle, scale);
}

double eps_of_sigma(double sigma, const PlaneScale& scale) {
  return std::clamp(kSigmas * sigma, kTightest * scale.eps_d, scale.eps_d);
}

bool is_sharp(double own_eps, const PlaneScale& scale) {
  constexpr double kSharp = 0.95;
  return own_eps < kSharp * scale.eps_d;
}

PlaneMixtureOptions mixture_options(const PlaneScale& scale) {
  PlaneMixtureOptions options;
  options.reach = 2.0 * scale.eps_d;
  options.min_sigma = kTightest * scale.eps_d / kSigmas;
  options.max_sigma = scale.eps_pi;
  return options;
}

int strong_support(const Plane& plane, const PlaneContext& context) {
  constexpr std::size_t kManyObservers = 5;
  constexpr double kConfirmed = 0.6;
  constexpr double kUnmaskedAtLast = 0.8;
  double factor = 1.0;
  if (context.stereo) {
    factor = kStereo;
  } else if (plane.label == 0) {
    factor = context.finished ? kUnmaskedAtLast : context.rgbd ? kUnmaskedDepth : kUnmasked;
  } else if (plane.observers.size() >= kManyObservers) {
    factor = kConfirmed;
  }
  return static_cast<int>(std::lround(factor * context.options.strong_inliers));
}

int least_observers(const Plane& plane, const PlaneContext& context) {
  if (context.rgbd) return 1;
  return plane.label > 0 ? 2 : 3;
}

bool may_be_slab(const Plane& plane, const PlanePoints& support, const PlaneContext& context) {
  const bool vouched = context.rgbd && plane.label > 0;
  const bool proved =
      context.finished && support.size() >= kUnmasked * context.options.strong_inliers;
  if (vouched || proved || context.young || context.options.merge == PlaneMerge::kPaper)
    return false;
  return !is_sharp(own_eps({plane.normal, plane.offset}, support, context.scale), context.scale);
}

void update_figures(Plane& plane, const PlaneSupport& support, const PlaneContext& context) {
  double sum = 0.0;
  double weight = 0.0;
  for (int i = 0; i < support.points.size(); ++i) {
    const double distance = plane.signed_distance(support.points.positions[i]);
    const double w = 1.0 / (support.points.band[i] * support.points.band[i]);
    sum += w * distance * distance;
    weight += w;
  }
  plane.rms = weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
  plane.inliers = static_cast<int>(support.landmarks.size());
  plane.weak = support.points.size() < strong_support(plane, context) ||
               static_cast<int>(plane.observers.size()) < least_observers(plane, context) ||
               may_be_slab(plane, support.points, context);
}

void add_depth_point(Plane& plane, KeyframeId keyframe, const Eigen::Vector3d& position,
                     const Eigen::Vector3f& point_cam) {
  plane.depth_points.push_back(position);
  plane.depth_anchors.push_back({keyframe, point_cam});
}

void bound_depth_points(Plane& plane, int most, double cell) {
  // With some slack, so that not every keyframe costs a thinning.
  if (2 * static_cast<int>(plane.depth_points.size()) <= 3 * most) return;
  const Pose plane_from_world = plane.world_from_plane().inverse();
  std::vector<Eigen::Vector2d> flat;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(HUGE_VAL);
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector3d& point : plane.depth_points) {
    flat.push_back((plane_from_world * point).head<2>());
    low = low.cwiseMin(flat.back());
    high = high.cwiseMax(flat.back());
  }
  // At most so fine can a grid be whose cells are all taken.
  cell = std::max(cell, 0.5 * std::sqrt((high - low).prod() / most));
  std::vector<std::size_t> kept;
  do {
    // (cell column, cell row, -index): sorted, the latest of each cell comes first.
    std::vector<std::tuple<int, int, int>> cells;
    for (std::size_t i = 0; i < flat.size(); ++i) {
      cells.emplace_back(static_cast<int>(std::floor(flat[i].x() / cell)),
                         static_cast<int>(std::floor(flat[i].y() / cell)), -static_cast<int>(i));
    }
    std::sort(cells.begin(), cells.end());
    kept.clear();
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const auto& [col, row, index] = cells[k];
      if (k > 0 && std::get<0>(cells[k - 1]) == col && std::get<1>(cells[k - 1]) == row) continue;
      kept.push_back(static_cast<std::size_t>(-index));
    }
    cell *= 1.3;
  } while (static_cast<int>(kept.size()) > most);
  std::sort(kept.begin(), kept.end());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    plane.depth_points[k] = plane.depth_points[kept[k]];
    plane.depth_anchors[k] = plane.depth_anchors[kept[k]];
  }
  plane.depth_points.resize(kept.size());
  plane.depth_anchors.resize(kept.size());
}

void erase_plane(Map& map, PlaneId plane) {
  for (Landmark& landmark : map.landmarks) {
    if (landmark.plane == plane) landmark.plane = kNone;
  }
  map.planes.erase(plane);
}

double link_of(const std::vector<Eigen::Vector3d>& support, const PlaneScale& scale) {
  return std::min(link_in_mask(support, scale), 6.0 * scale.link);
}

double link_in_mask(const std::vector<Eigen::Vector3d>& support, const PlaneScale& scale) {
  return std::max(linking_distance(support), 2.0 * scale.link);
}

}  // namespace planecast::slam
