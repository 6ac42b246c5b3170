#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "slam/fitting/graph_cut_ransac.h"
#include "slam/fitting/neighbourhood.h"
#include "slam/fitting/plane_mixture.h"
#include "slam/fitting/plane_model.h"
#include "slam/fitting/samplers.h"
#include "slam/fitting/sequential.h"
#include "slam/stages/plane_directions.h"
#include "slam/stages/plane_plausibility.h"
#include "slam/stages/plane_steps.h"

namespace planecast::slam {

namespace {

/// Inliers that a plane must have where no mask speaks for it.
constexpr int kMinUnmasked = 20;
constexpr double kMinMaskRatio = 0.3;  ///< of a mask group's points that must be inliers
/// [D] Without masks the fits' threshold is eps_Pi. A slab of the wider eps_d cut through a stair
/// or through clutter holds more points than a true plane, and a plane must be as thin as eps_Pi in
/// the end anyway.
constexpr double kBackgroundCost = 0.5;
constexpr int kMaxModelsWithoutMasks = 8;
constexpr int kMaxModelsPerMask = 3;
/// [D] Of all points of a mask, that a plane in it must hold. Fewer are what leaked in: they are on
/// what adjoins, which has a mask of its own or is no plane.
constexpr double kMinShareOfMask = 0.25;
/// Implausible fits after which nothing better is expected: fits come in order of their score.
constexpr int kMaxImplausible = 2;
constexpr int kMaxSamples = 500;

/// Half of the samples are uniform [P], half are a point and two of its neighbours in the image
/// [D]: without masks a plane may have a tenth of the points, of which uniform samples find a
/// thousandth.
class LocalPlaneSampler {
 public:
  LocalPlaneSampler(const NearestTable& nearest, const std::vector<int>& pool)
      : nearest_(nearest), pool_(pool), in_pool_(nearest.index.size() / nearest.count, -1) {
    for (std::size_t i = 0; i < pool.size(); ++i) in_pool_[pool[i]] = static_cast<int>(i);
  }
  void draw(Random& random, int* sample) {
    const int n = static_cast<int>(pool_.size());
    local_ = !local_;
    if (local_ && draw_local(random, random.below(n), sample)) return;
    random.distinct(PlaneModel::kSampleSize, n, sample);
  }

 private:
  bool draw_local(Random& random, int centre, int* sample) {
    std::array<int, PlaneModel::kSampleSize - 1> choice;
    random.distinct(static_cast<int>(choice.size()), nearest_.count, choice.data());
    sample[0] = centre;
    for (std::size_t k = 0; k < choice.size(); ++k) {
      const int point =
          nearest_.index[static_cast<std::size_t>(pool_[centre]) * nearest_.count + choice[k]];
      if (point < 0 || in_pool_[point] < 0) return false;
      sample[k + 1] = in_pool_[point];
    }
    return true;
  }

  const NearestTable& nearest_;
  const std::vector<int>& pool_;
  std::vector<int> in_pool_;
  bool local_ = false;
};

PlanePoints select(const PlanePoints& points, const std::vector<int>& indices) {
  PlanePoints result;
  for (const int i : indices) {
    result.positions.push_back(points.positions[i]);
    result.view_from.push_back(points.view_from[i]);
    result.band.push_back(points.band[i]);
  }
  return result;
}

/// Finds the planes of one keyframe.
class PlaneFinder {
 public:
  PlaneFinder(Map& map, KeyframeId keyframe, const PlaneContext& context, KeyframePoints& shown)
      : map_(map), keyframe_(keyframe), context_(context), shown_(shown) {
    for (const double band : shown.points.band) weights_.push_back(1.0 / (band * band));
  }

  int find_in_masks() {
    std::vector<MaskGroup> groups = groups_in_masks();
    int found = 0;
    // The largest plane of every mask before what it leaves, which may be a neighbour's.
    for (int round = 0; round < kMaxModelsPerMask; ++round) {
      for (MaskGroup& group : groups) found += fit_in_mask(group);
    }
    return found;
  }

  int find_without_masks() {
    int found = 0;
    if (shown_.has_normals) {
      for (const DirectionGroup& group : groups_by_direction(shown_, unowned(), min_unmasked())) {
        found += find_in_group(group);
      }
    }
    // Of thin and far surfaces no normal is known.
    return found + find_in_group({unowned()});
  }

 private:
  std::vector<int> unowned() const {
    std::vector<int> result;
    for (int i = 0; i < shown_.size(); ++i) {
      if (shown_.plane[i] == kNone) result.push_back(i);
    }
    return result;
  }

  int min_unmasked() const { return std::max(context_.options.min_inliers, kMinUnmasked); }

  /// What a mask shows that no plane owns.
  struct MaskGroup {
    int label = 0;
    int in_mask = 0;        ///< points of the mask, owned or not
    std::vector<int> left;  ///< those to which a plane may be fitted yet
  };

  /// Most to fit first, ties by label.
  std::vector<MaskGroup> groups_in_masks() const {
    std::vector<MaskGroup> groups;
    for (std::vector<int>& points : groups_by_label(shown_.label, context_.options.min_inliers)) {
      const auto in_mask = static_cast<int>(points.size());
      const int label = shown_.label[points.front()];
      std::erase_if(points, [&](int i) { return shown_.plane[i] != kNone; });
      groups.push_back({label, in_mask, std::move(points)});
    }
    std::sort(groups.begin(), groups.end(), [](const MaskGroup& a, const MaskGroup& b) {
      if (a.left.size() != b.left.size()) return a.left.size() > b.left.size();
      return a.label < b.label;
    });
    return groups;
  }

  /// Planes one after the other among points that no mask speaks for.
  int find_in_group(const DirectionGroup& group) {
    int found = 0;
    int implausible = 0;
    const int min_size = min_unmasked();
    fit_sequentially(
        group.points, min_size, kMaxModelsWithoutMasks, [&](const std::vector<int>& left) {
          if (implausible == kMaxImplausible) return std::vector<int>();
          auto candidate = fit(left, context_.scale.eps_pi, 0.0, group.direction);
          if (!candidate) return std::vector<int>();
          // A slab of clutter leaves the pool too, or it would be found again.
          const std::vector<int> consumed = candidate->inliers;
          ++implausible;
          if (!tighten(left, *candidate)) return consumed;
          const bool coherent = coherence(shown_, *candidate) > plausible_.min_coherence;
          keep_coherent(shown_, plausible_, *candidate);
          keep_connected(shown_, context_.scale, *candidate);
          if (!coherent || static_cast<int>(candidate->inliers.size()) < min_size ||
              !is_plausible(*candidate)) {
            return consumed;
          }
          --implausible;
          add_plane(*candidate, 0);
          ++found;
          return candidate->inliers;
        });
    return found;
  }

  /// Fits a plane to what is left of the mask; whether there is one. What it explains leaves the
  /// group, and so does everything where there is none.
  bool fit_in_mask(MaskGroup& group) {
    std::erase_if(group.left, [&](int i) { return shown_.plane[i] != kNone; });
    const std::vector<int> pool = std::exchange(group.left, {});
    if (static_cast<int>(pool.size()) < context_.options.min_inliers) return false;
    auto candidate = fit(pool, context_.scale.eps_d, kMinMaskRatio, Eigen::Vector3d::Zero());
    if (!candidate || !tighten(pool, *candidate)) return false;
    candidate->label = group.label;
    keep_connected(shown_, context_.scale, *candidate);
    const auto inliers = static_cast<int>(candidate->inliers.size());
    if (inliers < context_.options.min_inliers || inliers < kMinShareOfMask * group.in_mask ||
        !is_plausible(*candidate)) {
      return false;
    }
    add_plane(*candidate, group.label);
    for (const int i : pool) {
      const double distance = candidate->plane.signed_distance(shown_.points.positions[i]);
      const bool explained = std::abs(distance) < shown_.points.band[i] * context_.scale.eps_d;
      if (!explained) group.left.push_back(i);
    }
    return true;
  }

  RansacOptions ransac_options(double threshold, double min_ratio) const {
    RansacOptions options;
    options.threshold = threshold;
    options.max_rms = context_.scale.eps_pi;
    options.lambda = context_.options.lambda;
    // What leaks into a mask is told by its neighbours. Without masks everything adjoins something
    // else, and true points would go out with it.
    options.pairs_by_contrast = !shown_.has_masks;
    options.min_inliers = context_.options.min_inliers;
    options.min_inlier_ratio = min_ratio;
    options.graph_cut = context_.options.graph_cut;
    options.max_samples = kMaxSamples;
    options.max_stagnant_rounds = 1;
    return options;
  }

  std::optional<PlaneCandidate> fit(const std::vector<int>& group, double threshold,
                                    double min_ratio, const Eigen::Vector3d& direction) {
    const PlanePoints points = select(shown_.points, group);
    const FacingPlaneModel model(points, direction);
    std::vector<NeighbourPair> neighbours;
    if (context_.options.graph_cut) {
      neighbours = radius_neighbours(points.positions, 2.0 * context_.scale.link);
    }
    RansacOptions options = ransac_options(threshold, min_ratio);
    if (!shown_.has_masks) options.background_cost = kBackgroundCost;
    options.seed =
        mix_seed(context_.options.seed, static_cast<std::uint64_t>(keyframe_) * 4096 + ++fits_);
    const auto result = run(model, group, neighbours, options);
    if (!result.accepted) return std::nullopt;
    PlaneCandidate candidate;
    candidate.plane = result.model;
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (result.inlier[i]) candidate.inliers.push_back(group[i]);
    }
    return candidate;
  }

  RansacResult<PlaneEquation> run(const FacingPlaneModel& model, const std::vector<int>& group,
                                  const std::vector<NeighbourPair>& neighbours,
                                  const RansacOptions& options) {
    if (model.size() < PlaneModel::kSampleSize) return {};
    if (shown_.has_masks) {
      UniformSampler sampler(model.size(), PlaneModel::kSampleSize);
      return GraphCutRansac(model, sampler, neighbours, options).run();
    }
    LocalPlaneSampler sampler(shown_.nearest, group);
    return GraphCutRansac(model, sampler, neighbours, options).run();
  }

  /// Points of the pool seen from the plane's front within `eps` times their band.
  std::vector<int> near(const std::vector<int>& pool, const PlaneCandidate& candidate,
                        double eps) const {
    std::vector<int> result;
    for (const int i : pool) {
      const double distance = candidate.plane.signed_distance(shown_.points.positions[i]);
      if (std::abs(distance) < shown_.points.band[i] * eps &&
          shown_.points.view_from[i].dot(candidate.plane.normal) > 0.0 &&
          shown_.may_face(i, candidate.plane.normal)) {
        result.push_back(i);
      }
    }
    return result;
  }

  /// Brings the plane from among what stands before it onto its own points, and its inlier distance
  /// down to its own. False where it is degenerate or thicker than eps_Pi.
  bool tighten(const std::vector<int>& pool, PlaneCandidate& candidate) const {
    const PlaneMixtureOptions options = mixture_options(context_.scale);
    const auto mixture = fit_plane_mixture(shown_.points, near(pool, candidate, options.reach),
                                           candidate.plane, options);
    if (!mixture) return false;
    candidate.plane = mixture->plane;
    candidate.eps = eps_of_sigma(mixture->sigma, context_.scale);
    candidate.inliers = near(pool, candidate, candidate.eps);
    const auto fitted = fit_plane(shown_.points.positions, candidate.inliers, weights_);
    return fitted && fitted->rms < context_.scale.eps_pi;
  }

  bool is_plausible(const PlaneCandidate& candidate) const {
    return is_faced(shown_, candidate, context_.scale, plausible_) &&
           is_broad(shown_, candidate, plausible_) &&
           contrast(map_, shown_, candidate, context_.scale) > plausible_.min_contrast;
  }

  void add_plane(const PlaneCandidate& candidate, int label) {
    const Keyframe& keyframe = map_.keyframes.at(keyframe_);
    Plane plane;
    plane.id = map_.planes.next_id();
    plane.normal = candidate.plane.normal;
    plane.offset = candidate.plane.offset;
    for (const int i : candidate.inliers) plane.origin += shown_.points.positions[i];
    plane.origin /= static_cast<double>(candidate.inliers.size());
    plane.x_axis = keyframe.cam_from_world.linear().row(0).transpose();
    plane.refit(plane.normal, plane.offset);
    plane.first_frame = keyframe.frame_index;
    plane.label = label;
    plane.observers = {keyframe_};
    for (const int i : candidate.inliers) {
      shown_.plane[i] = plane.id;
      if (shown_.landmark[i] == kNone) {
        add_depth_point(plane, keyframe_, shown_.points.positions[i], shown_.point_cam[i]);
      } else {
        map_.landmarks.at(shown_.landmark[i]).plane = plane.id;
        ++plane.inliers;
      }
    }
    plane.weak = static_cast<int>(candidate.inliers.size()) < strong_support(plane, context_) ||
                 least_observers(plane, context_) > 1;
    map_.planes.put(std::move(plane));
  }

  Map& map_;
  KeyframeId keyframe_;
  const PlaneContext& context_;
  KeyframePoints& shown_;
  PlausibilityOptions plausible_;
  std::vector<double> weights_;  ///< of the points in least squares
  std::uint64_t fits_ = 0;
};

}  // namespace

int find_planes(Map& map, KeyframeId keyframe, const PlaneContext& context, KeyframePoints& shown) {
  if (shown.size() < context.options.min_inliers) return 0;
  PlaneFinder finder(map, keyframe, context, shown);
  return shown.has_masks ? finder.find_in_masks() : finder.find_without_masks();
}

}  // namespace planecast::slam
