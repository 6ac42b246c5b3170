#include <algorithm>
#include <cmath>
#include <cstddef>

#include "slam/stages/plane_plausibility.h"
#include "slam/stages/plane_steps.h"

namespace planecast::slam {

namespace {

/// A mask instance is a plane's if the plane owns this share of the instance's owned landmarks, and
/// so many.
constexpr double kMaskShare = 0.5;
constexpr int kMinMaskVotes = 3;
/// Support within linking distance that a point needs to join.
constexpr int kMinNeighbours = 2;
/// Of kCoherenceNeighbours, that the plane must explain for a point to join where there are no
/// masks: more for a plane that has yet to prove itself.
constexpr int kMinExplainedByLarge = 1;
constexpr int kLargeSupport = 100;
constexpr int kMinExplained = 3;
/// Landmarks by which a keyframe becomes an observer of a plane.
constexpr int kMinObserved = 5;
/// Depth points kept per plane.
constexpr int kMostDepthPoints = 400;
/// Support points kept for the search of neighbours.
constexpr int kMostSupport = 600;
/// Rounds in which what has just joined may bring in its neighbours.
constexpr int kRounds = 3;

/// Where masks do not speak for it, a plane is judged in every keyframe that shows so many of its
/// points, by looser limits than at its birth.
constexpr int kMinJudged = 25;
constexpr double kDoubtfulCoherence = 0.4;
constexpr double kDoubtfulContrast = 2.0;
constexpr int kMostDoubts = 2;
/// RMS, in eps_Pi, beyond which a plane's support has stopped being one.
constexpr double kMaxThickness = 1.5;

/// Which mask instances of this image are which plane's.
class MaskVotes {
 public:
  MaskVotes(const KeyframePoints& shown, int num_planes)
      : has_masks_(shown.has_masks), num_planes_(static_cast<std::size_t>(num_planes)) {
    int labels = 0;
    for (const int label : shown.label) labels = std::max(labels, label + 1);
    votes_.assign(static_cast<std::size_t>(labels) * num_planes_, 0);
    total_.assign(static_cast<std::size_t>(labels), 0);
    for (int i = 0; i < shown.size(); ++i) {
      if (shown.label[i] <= 0 || shown.plane[i] == kNone) continue;
      ++votes_[shown.label[i] * num_planes_ + shown.plane[i]];
      ++total_[shown.label[i]];
    }
  }
  /// Without masks every plane may take every point.
  bool allow(int label, PlaneId plane) const {
    if (!has_masks_) return true;
    if (label <= 0) return false;
    const int votes = votes_[label * num_planes_ + plane];
    return votes >= kMinMaskVotes && votes >= kMaskShare * total_[label];
  }

 private:
  bool has_masks_;
  std::size_t num_planes_;
  std::vector<int> votes_;
  std::vector<int> total_;
};

/// Evenly chosen support, kept small because every candidate is compared with all of it.
std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points) {
  const std::size_t step = (points.size() + kMostSupport - 1) / kMostSupport;
  std::vector<Eigen::Vector3d> result;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(step, 1)) {
    result.push_back(points[i]);
  }
  return result;
}

int min_explained(const GrowingPlane& growing) {
  return static_cast<int>(growing.support.size()) < kLargeSupport ? kMinExplained
                                                                  : kMinExplainedByLarge;
}

void extend_box(GrowingPlane& growing, const Eigen::Vector3d& point) {
  growing.low = growing.low.cwiseMin(point);
  growing.high = growing.high.cwiseMax(point);
}

bool is_near(GrowingPlane& growing, const Eigen::Vector3d& point, bool in_mask,
             const PlaneScale& scale) {
  if (!growing.link) {
    growing.link = in_mask ? link_in_mask(growing.support, scale) : link_of(growing.support, scale);
  }
  const double link = *growing.link;
  if ((point.array() < growing.low.array() - link).any() ||
      (point.array() > growing.high.array() + link).any()) {
    return false;
  }
  int near = 0;
  for (const Eigen::Vector3d& other : growing.support) {
    if ((other - point).squaredNorm() < link * link && ++near >= kMinNeighbours) return true;
  }
  return false;
}

/// Nearest image neighbours of point i that the plane explains too, whoever owns them: without
/// masks, what lies amid other things is not on the plane even if it is near it.
int explained_neighbours(const KeyframePoints& shown, int i, const Plane& plane, double eps_d) {
  int count = 0;
  for (int k = 0; k < kCoherenceNeighbours; ++k) {
    const int other = shown.nearest.index[static_cast<std::size_t>(i) * shown.nearest.count + k];
    if (other < 0) continue;
    const double distance = std::abs(plane.signed_distance(shown.points.positions[other]));
    count += distance < shown.points.band[other] * eps_d;
  }
  return count;
}

/// The nearest plane that takes point i, or null.
GrowingPlane* taker_of(const Map& map, std::vector<GrowingPlane>& planes,
                       const KeyframePoints& shown, int i, const MaskVotes& masks,
                       const PlaneScale& scale) {
  const PlanePoints& points = shown.points;
  double best = HUGE_VAL;
  GrowingPlane* taker = nullptr;
  for (GrowingPlane& growing : planes) {
    const Plane& plane = map.planes.at(growing.plane);
    const double distance = std::abs(plane.signed_distance(points.positions[i]));
    if (distance >= std::min(best, points.band[i] * growing.eps)) continue;
    if (points.view_from[i].dot(plane.normal) <= 0.0) continue;
    if (!masks.allow(shown.label[i], plane.id) || !shown.may_face(i, plane.normal)) continue;
    if (!shown.has_masks &&
        explained_neighbours(shown, i, plane, growing.eps) < min_explained(growing)) {
      continue;
    }
    if (!is_near(growing, points.positions[i], shown.has_masks, scale)) continue;
    best = distance;
    taker = &growing;
  }
  return taker;
}

void note_observer(Plane& plane, KeyframeId keyframe) {
  const auto place = std::lower_bound(plane.observers.begin(), plane.observers.end(), keyframe);
  if (place == plane.observers.end() || *place != keyframe) plane.observers.insert(place, keyframe);
}

void note_observers(Map& map, KeyframeId keyframe, const KeyframePoints& shown) {
  std::vector<int> count(static_cast<std::size_t>(map.planes.next_id()), 0);
  for (int i = 0; i < shown.observed; ++i) {
    if (shown.plane[i] != kNone) ++count[shown.plane[i]];
  }
  for (Plane& plane : map.planes) {
    if (count[plane.id] >= kMinObserved) note_observer(plane, keyframe);
  }
}

}  // namespace

void prepare_growth(const Map& map, const PlaneContext& context,
                    std::vector<GrowingPlane>& planes) {
  const auto is_new = [&](const Plane& plane) {
    return std::none_of(planes.begin(), planes.end(),
                        [&](const GrowingPlane& known) { return known.plane == plane.id; });
  };
  std::vector<PlaneSupport> support;
  for (const Plane& plane : map.planes) {
    if (!is_new(plane)) continue;
    if (support.empty()) support = gather_support(map, context);
    const PlanePoints& points = support[static_cast<std::size_t>(plane.id)].points;
    GrowingPlane growing;
    growing.plane = plane.id;
    growing.support = thinned(points.positions);
    growing.low.setConstant(HUGE_VAL);
    growing.high.setConstant(-HUGE_VAL);
    for (const Eigen::Vector3d& point : growing.support) extend_box(growing, point);
    growing.eps = own_eps({plane.normal, plane.offset}, points, context.scale);
    planes.push_back(std::move(growing));
  }
}

int expand_planes(Map& map, KeyframeId keyframe, const PlaneContext& context, KeyframePoints& shown,
                  std::vector<GrowingPlane>& planes) {
  if (map.planes.empty()) return 0;
  const MaskVotes masks(shown, map.planes.next_id());
  int joined = 0;
  for (int round = 0, gained = 1; round < kRounds && gained > 0; ++round) {
    gained = 0;
    for (int i = 0; i < shown.size(); ++i) {
      if (shown.plane[i] != kNone) continue;
      GrowingPlane* taker = taker_of(map, planes, shown, i, masks, context.scale);
      if (taker == nullptr) continue;
      Plane& plane = map.planes.at(taker->plane);
      shown.plane[i] = plane.id;
      taker->support.push_back(shown.points.positions[i]);
      extend_box(*taker, shown.points.positions[i]);
      plane.stalled_keyframes = 0;
      ++gained;
      if (shown.landmark[i] == kNone) {
        add_depth_point(plane, keyframe, shown.points.positions[i], shown.point_cam[i]);
      } else {
        map.landmarks.at(shown.landmark[i]).plane = plane.id;
        ++joined;
      }
    }
  }
  for (Plane& plane : map.planes) {
    bound_depth_points(plane, kMostDepthPoints, context.scale.link);
  }
  note_observers(map, keyframe, shown);
  return joined;
}

void doubt_planes(Map& map, const PlaneContext& context, const KeyframePoints& shown) {
  if (shown.has_masks) return;
  for (Plane& plane : map.planes) {
    PlaneCandidate candidate{{plane.normal, plane.offset}, {}, 0.0};
    PlanePoints support;
    for (int i = 0; i < shown.size(); ++i) {
      if (shown.plane[i] != plane.id) continue;
      candidate.inliers.push_back(i);
      support.positions.push_back(shown.points.positions[i]);
      support.band.push_back(shown.points.band[i]);
    }
    candidate.eps = own_eps(candidate.plane, support, context.scale);
    if (static_cast<int>(candidate.inliers.size()) < kMinJudged) continue;
    const bool thin = !may_be_slab(plane, support, context);
    const bool good = thin && coherence(shown, candidate) > kDoubtfulCoherence &&
                      contrast(map, shown, candidate, context.scale) > kDoubtfulContrast;
    plane.doubts = good ? std::max(plane.doubts - 1, 0) : plane.doubts + 1;
  }
}

int drop_weak_planes(Map& map, const PlaneContext& context) {
  const std::vector<PlaneSupport> support = gather_support(map, context);
  std::vector<PlaneId> dropped;
  for (Plane& plane : map.planes) {
    if (plane.id < context.fixed_planes) continue;
    update_figures(plane, support[plane.id], context);
    const bool starved = support[plane.id].points.size() < context.options.min_inliers;
    // What the paper's merging joins may be thick; it has no such test.
    const bool thick = context.options.merge == PlaneMerge::kDefault &&
                       plane.rms > kMaxThickness * context.scale.eps_pi;
    const bool stalled =
        plane.weak && plane.stalled_keyframes >= context.options.weak_max_keyframes;
    if (starved || thick || stalled || plane.doubts > kMostDoubts) dropped.push_back(plane.id);
    ++plane.age_keyframes;
    ++plane.stalled_keyframes;
  }
  for (const PlaneId id : dropped) erase_plane(map, id);
  return static_cast<int>(dropped.size());
}

}  // namespace planecast::slam
