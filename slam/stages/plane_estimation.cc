#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "slam/geometry/random.h"
#include "slam/stages/plane_plausibility.h"
#include "slam/stages/plane_steps.h"

namespace planecast::slam {

namespace {

/// Subsets of either size tried per re-estimation.
constexpr int kSubsets = 12;
/// Share of the support in each subset [P].
constexpr double kSubsetShare = 0.6;
constexpr std::size_t kFewest = 3;
/// Points that a re-estimation looks at; more would only take time.
constexpr int kMostPoints = 400;
/// Growth of the score that is worth a new equation.
constexpr double kBetter = 1.001;
/// [D] Of the own support's score that a new equation must keep: a plane is refined, not exchanged
/// for another that runs through its surroundings.
constexpr double kKept = 0.75;
/// Distance, in bands, beyond which support is let go.
constexpr double kFarBands = 1.5;
/// [D] Share of what is near a plane that may be seen through it, by mistake.
constexpr double kMostBehind = 0.02;
/// [D] Points that are seen through a plane by mistake, over those on it.
constexpr double kSeenThrough = 0.06;
/// Landmarks of a plane in a keyframe for it to count as seen there.
constexpr int kSeenLandmarks = 3;

/// Sum of Gaussian kernels of the points' distances over their bands.
double score_of(const PlaneEquation& plane, const PlanePoints& points,
                const std::vector<int>& indices, double eps) {
  double score = 0.0;
  for (const int i : indices) {
    const double r = plane.signed_distance(points.positions[i]) / (points.band[i] * eps);
    if (points.view_from[i].dot(plane.normal) > 0.0) score += std::exp(-0.5 * r * r);
  }
  return score;
}

std::vector<double> weights_of(const PlanePoints& points) {
  std::vector<double> weights;
  weights.reserve(points.band.size());
  for (const double band : points.band) weights.push_back(1.0 / (band * band));
  return weights;
}

/// The fit with its normal on the side of `normal`.
PlaneEquation facing(const PlaneEquation& plane, const Eigen::Vector3d& normal) {
  return plane.normal.dot(normal) < 0.0 ? plane.flipped() : plane;
}

Eigen::Vector3d mean_view(const PlanePoints& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& view : points.view_from) sum += view;
  return sum;
}

/// An even choice of at most `most` of n.
std::vector<int> evenly(int n, int most = kMostPoints) {
  const int step = (n + most - 1) / most;
  std::vector<int> result;
  for (int i = 0; i < n; i += std::max(step, 1)) result.push_back(i);
  return result;
}

/// Brings `count` random points of the pool to its front.
void draw(std::size_t count, std::vector<int>& pool, Random& random) {
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(pool[i], pool[i + random.below(static_cast<int>(pool.size() - i))]);
  }
}

/// The best, for the tightest inlier distance, of fits to random subsets of the pool: to 60 % of it
/// [P], and to as few points as make a plane [D], for every large subset holds its share of what
/// does not belong.
std::optional<PlaneEquation> best_of_subsets(const PlanePoints& points, std::vector<int> pool,
                                             const Eigen::Vector3d& normal,
                                             const PlaneContext& context, Random& random) {
  const auto large =
      static_cast<std::size_t>(std::lround(kSubsetShare * static_cast<double>(pool.size())));
  const std::vector<double> weights = weights_of(points);
  const double eps = eps_of_sigma(0.0, context.scale);
  std::optional<PlaneEquation> best;
  double best_score = 0.0;
  for (int k = 0; k < 2 * kSubsets; ++k) {
    const std::size_t size = k % 2 == 0 ? large : static_cast<std::size_t>(kFewest);
    draw(size, pool, random);
    const std::vector<int> subset(pool.begin(), pool.begin() + static_cast<std::ptrdiff_t>(size));
    const auto fit = fit_plane(points.positions, subset, weights);
    if (!fit) continue;
    const PlaneEquation candidate = facing(fit->plane, normal);
    const double score = score_of(candidate, points, pool, eps);
    if (score <= best_score) continue;
    best_score = score;
    best = candidate;
  }
  return best;
}

/// Adds to the plane's support, thinned to `most`, the landmarks that no plane owns about it [D]:
/// judged by its own support alone a tilted plane would confirm itself, for what it misses is not
/// in there.
PlanePoints with_surroundings(const Map& map, const PlanePoints& support,
                              const PlaneContext& context, int most = kMostPoints) {
  PlanePoints points;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int i : evenly(support.size(), most)) {
    points.positions.push_back(support.positions[i]);
    points.view_from.push_back(support.view_from[i]);
    points.band.push_back(support.band[i]);
    centre += support.positions[i];
  }
  centre /= std::max(points.size(), 1);
  double squared_radius = 0.0;
  for (const Eigen::Vector3d& point : points.positions) {
    squared_radius = std::max(squared_radius, (point - centre).squaredNorm());
  }
  for (const Landmark& landmark : map.landmarks) {
    if (map.planes.contains(landmark.plane) || landmark.observations.empty()) continue;
    if ((landmark.position - centre).squaredNorm() > squared_radius) continue;
    points.positions.push_back(landmark.position);
    points.view_from.push_back(landmark.view_from);
    points.band.push_back(band_of_landmark(map, landmark, context));
  }
  return points;
}

/// Starts for settle(): the present plane, and of those through random triples that are near it the
/// ones with most points close by.
std::vector<PlaneEquation> settling_starts(const PlanePoints& points, std::vector<int> pool,
                                           const PlaneEquation& present, double sigma, double reach,
                                           Random& random) {
  constexpr int kTriples = 400;
  constexpr std::size_t kKept = 6;
  static const double kLeastCosine = std::cos(15.0 * std::numbers::pi / 180.0);
  std::erase_if(pool, [&](int i) {
    return std::abs(present.signed_distance(points.positions[static_cast<std::size_t>(i)])) > reach;
  });
  std::vector<PlaneEquation> starts = {present};
  if (pool.size() < 2 * kFewest) return starts;
  std::vector<std::pair<double, PlaneEquation>> rivals;
  for (int k = 0; k < kTriples; ++k) {
    draw(kFewest, pool, random);
    const auto fit = fit_plane(points.positions, {pool.begin(), pool.begin() + kFewest}, {});
    if (!fit) continue;
    const PlaneEquation rival = facing(fit->plane, present.normal);
    if (rival.normal.dot(present.normal) < kLeastCosine) continue;
    rivals.emplace_back(score_of(rival, points, pool, sigma), rival);
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; i < std::min(kKept, rivals.size()); ++i) {
    starts.push_back(rivals[i].second);
  }
  return starts;
}

/// Refits the plane to the likeliest thin sheet in its points. False, and nothing changed, where
/// there is none.
bool settle(const PlanePoints& points, Plane& plane, const PlaneContext& context,
            std::uint64_t seed) {
  const std::vector<int> pool = evenly(points.size());
  Random random(seed);
  PlaneMixtureOptions options = mixture_options(context.scale);
  options.max_sigma = options.min_sigma;
  options.max_behind = kMostBehind;
  const PlaneEquation present{plane.normal, plane.offset};
  const auto best = fit_plane_mixture(
      points, pool,
      settling_starts(points, pool, present, options.max_sigma, options.reach, random), options);
  if (!best) return false;
  plane.refit(best->plane.normal, best->plane.offset);
  return true;
}

/// Whether more is seen through a plane than strays, by two standard deviations of their number.
bool is_slab(const Plane& plane, const PlanePoints& points, double eps, const PlaneScale& scale) {
  const SeenThrough seen = count_seen_through({plane.normal, plane.offset}, points, eps, scale);
  const double strays = kSeenThrough * seen.on_plane;
  return seen.through > strays + 2.0 * std::sqrt(strays);
}

bool reestimate(const Map& map, Plane& plane, const PlaneSupport& support,
                const PlaneContext& context, std::uint64_t seed) {
  const bool alone = plane.label > 0;  // what its mask left out is not on it
  const PlanePoints points =
      alone ? support.points : with_surroundings(map, support.points, context);
  const std::vector<int> pool = evenly(points.size());
  if (pool.size() < 2 * kFewest) return false;
  Random random(seed);
  const PlaneEquation present{plane.normal, plane.offset};
  std::vector<PlaneEquation> starts = {present};
  const auto rival = best_of_subsets(points, pool, plane.normal, context, random);
  if (rival) starts.push_back(*rival);
  const auto best = fit_plane_mixture(points, pool, starts, mixture_options(context.scale));
  if (!best) return false;
  const double eps = eps_of_sigma(best->sigma, context.scale);
  const auto gain = [&](const PlanePoints& over) {
    const std::vector<int> all = evenly(over.size());
    return score_of(best->plane, over, all, eps) / score_of(present, over, all, eps);
  };
  if (!(gain(points) > kBetter) || !(gain(support.points) > kKept)) return false;
  plane.refit(best->plane.normal, best->plane.offset);
  return true;
}

/// Lets go what the new equation does not explain, farther than `most` over band: landmarks in view
/// are left to the next culling, those out of view would stay for ever.
void release_far_support(Map& map, Plane& plane, const PlaneSupport& support, double most) {
  const std::size_t landmarks = support.landmarks.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < support.points.positions.size(); ++i) {
    const double distance = std::abs(plane.signed_distance(support.points.positions[i]));
    const bool far = distance > most * support.points.band[i];
    if (i < landmarks) {
      if (far) map.landmarks.at(support.landmarks[i]).plane = kNone;
    } else if (!far) {
      plane.depth_points[kept] = plane.depth_points[i - landmarks];
      plane.depth_anchors[kept++] = plane.depth_anchors[i - landmarks];
    }
  }
  plane.depth_points.resize(kept);
  plane.depth_anchors.resize(kept);
}

/// Planes with at least kSeenLandmarks landmarks or any depth point in the keyframe.
std::vector<char> seen_planes(const Map& map, KeyframeId keyframe) {
  std::vector<int> count(static_cast<std::size_t>(map.planes.next_id()), 0);
  for (const LandmarkId id : map.keyframes.at(keyframe).landmarks) {
    const Landmark* landmark = map.landmarks.find(id);
    if (landmark != nullptr && map.planes.contains(landmark->plane)) ++count[landmark->plane];
  }
  std::vector<char> seen(count.size(), 0);
  for (const Plane& plane : map.planes) {
    const bool by_depth =
        !plane.depth_anchors.empty() && plane.depth_anchors.back().keyframe == keyframe;
    seen[plane.id] = count[plane.id] >= kSeenLandmarks || by_depth;
  }
  return seen;
}

}  // namespace

bool refit_robustly(Plane& plane, const PlaneSupport& support, const PlaneContext& context) {
  const PlanePoints& points = support.points;
  std::vector<int> used(points.positions.size());
  std::iota(used.begin(), used.end(), 0);
  const std::vector<double> weights = weights_of(points);
  PlaneEquation equation;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const auto fit = fit_plane(points.positions, used, weights);
    if (!fit) return false;
    equation = facing(fit->plane, mean_view(points));
    std::vector<double> distance;
    for (int i = 0; i < points.size(); ++i) {
      distance.push_back(std::abs(equation.signed_distance(points.positions[i])) / points.band[i]);
    }
    std::vector<double> sorted = distance;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double gate = std::max(context.scale.eps_d, 3.0 * *middle);
    used.clear();
    for (int i = 0; i < points.size(); ++i) {
      if (distance[i] < gate) used.push_back(i);
    }
  }
  const PlaneMixtureOptions options = mixture_options(context.scale);
  const PlaneEquation present{plane.normal, plane.offset};
  const auto mixture = fit_plane_mixture(points, used, std::vector{equation, present}, options);
  if (mixture) equation = mixture->plane;
  plane.refit(equation.normal, equation.offset);
  return true;
}

int reestimate_planes(Map& map, KeyframeId keyframe, const PlaneContext& context) {
  const std::vector<PlaneSupport> support = gather_support(map, context);
  const std::vector<char> seen = seen_planes(map, keyframe);
  int changed = 0;
  for (Plane& plane : map.planes) {
    if (!seen[plane.id] || plane.id < context.fixed_planes) continue;
    const std::uint64_t task = static_cast<std::uint64_t>(keyframe) * 4096 + plane.id;
    changed +=
        reestimate(map, plane, support[plane.id], context, mix_seed(context.options.seed, task));
    const double eps =
        own_eps({plane.normal, plane.offset}, support[plane.id].points, context.scale);
    release_far_support(map, plane, support[plane.id], kFarBands * eps);
  }
  return changed;
}

int settle_planes(Map& map, const PlaneContext& context) {
  const std::vector<PlaneSupport> support = gather_support(map, context);
  const double eps = eps_of_sigma(0.0, context.scale);
  int changed = 0;
  std::vector<char> slab(support.size(), 0);
  for (Plane& plane : map.planes) {
    if (plane.id < context.fixed_planes) continue;
    const PlanePoints& own = support[plane.id].points;
    const std::uint64_t task = static_cast<std::uint64_t>(plane.id);
    changed += settle(with_surroundings(map, own, context), plane, context,
                      mix_seed(context.options.seed, task));
    if (context.rgbd) continue;
    // Counted against each other, nothing may be thinned.
    const PlanePoints all = with_surroundings(map, own, context, std::max(own.size(), 1));
    slab[plane.id] = is_slab(plane, all, eps, context.scale);
  }
  // What only lies on a plane would bend it in the joint refinement.
  for (Plane& plane : map.planes) {
    if (plane.id >= context.fixed_planes) release_far_support(map, plane, support[plane.id], eps);
  }
  const std::vector<PlaneSupport> settled = gather_support(map, context);
  for (Plane& plane : map.planes) {
    if (plane.id < context.fixed_planes) continue;
    const bool was_weak = plane.weak;
    update_figures(plane, settled[plane.id], context);
    plane.weak = plane.weak || was_weak || slab[plane.id] != 0;
  }
  return changed;
}

void refit_planes(Map& map, const PlaneContext& context) {
  for (Plane& plane : map.planes) {
    for (std::size_t i = 0; i < plane.depth_points.size(); ++i) {
      const DepthAnchor& anchor = plane.depth_anchors[i];
      plane.depth_points[i] =
          map.keyframe_pose(anchor.keyframe).inverse() * anchor.point_cam.cast<double>();
    }
  }
  const std::vector<PlaneSupport> support = gather_support(map, context);
  for (Plane& plane : map.planes) {
    refit_robustly(plane, support[plane.id], context);
    update_figures(plane, support[plane.id], context);
  }
}

}  // namespace planecast::slam
