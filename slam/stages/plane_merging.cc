#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "slam/geometry/point_clusters.h"
#include "slam/stages/plane_steps.h"

namespace planecast::slam {

namespace {

const double kMinCosine = std::cos(15.0 * 3.14159265358979323846 / 180.0);
constexpr double kMaxCentroidDistance = 3.0;  ///< in eps_d
constexpr double kPaperMinCosine = 0.8;       ///< T_theta [P]
constexpr double kPaperMaxOffset = 10.0;      ///< T_d in eps_d [P]
constexpr std::size_t kMostCompared = 400;

/// The paper's own conditions, with its d/|d| read as d/|n|.
bool same_by_paper(const Plane& a, const Plane& b, const PlaneScale& scale) {
  return std::abs(a.normal.dot(b.normal)) > kPaperMinCosine &&
         std::abs(a.offset - b.offset) < kPaperMaxOffset * scale.eps_d;
}

Eigen::Vector3d centroid_of(const PlanePoints& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points.positions) sum += p;
  return sum / points.size();
}

std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points) {
  const std::size_t step =
      std::max<std::size_t>(1, (points.size() + kMostCompared - 1) / kMostCompared);
  std::vector<Eigen::Vector3d> result;
  for (std::size_t i = 0; i < points.size(); i += step) result.push_back(points[i]);
  return result;
}

/// How two planes' supports lie to one another.
struct Apart {
  PointGap gap;
  double link = 0.0;  ///< a shorter gap is none
  bool touch() const { return gap.distance < link; }
};

Apart how_apart(const PlanePoints& a, const PlanePoints& b, const PlaneScale& scale) {
  const std::vector<Eigen::Vector3d> points_a = thinned(a.positions);
  const std::vector<Eigen::Vector3d> points_b = thinned(b.positions);
  return {gap_between(points_a, points_b),
          std::max(link_of(points_a, scale), link_of(points_b, scale))};
}

/// Whether the strip of the plane between the two is known to be bare [D]: some keyframe looks at
/// its middle, and none sees through it what lies behind.
bool is_bare_between(const Map& map, const Plane& plane, const Apart& apart,
                     const PlaneContext& context) {
  constexpr int kMostSeenThrough = 2;
  constexpr double kClearlyBehind = 3.0;  // eps_d
  const Eigen::Vector3d along = (apart.gap.to - apart.gap.from) / apart.gap.distance;
  const Eigen::Vector3d middle = 0.5 * (apart.gap.from + apart.gap.to);
  const double width = std::max(apart.link, 0.25 * apart.gap.distance);
  bool looked_at = false;
  std::vector<char> counted(static_cast<std::size_t>(map.landmarks.next_id()), 0);
  int seen_through = 0;
  for (const Keyframe& keyframe : map.keyframes) {
    const Eigen::Vector3d centre = keyframe.centre_world();
    const double height = plane.signed_distance(centre);
    if (!(height > 0.0)) continue;
    const Eigen::Vector3d middle_cam = keyframe.cam_from_world * middle;
    looked_at = looked_at || (middle_cam.z() > 0.0 &&
                              context.camera.contains(context.camera.project(middle_cam)));
    for (const LandmarkId id : keyframe.landmarks) {
      const Landmark* landmark = map.landmarks.find(id);
      if (landmark == nullptr || counted[static_cast<std::size_t>(id)] != 0) continue;
      const double depth = -plane.signed_distance(landmark->position);
      if (depth < kClearlyBehind * context.scale.eps_d) continue;
      const Eigen::Vector3d crossing =
          centre + height / (height + depth) * (landmark->position - centre);
      const Eigen::Vector3d off = crossing - apart.gap.from;
      const double at = off.dot(along);
      if (at < 0.0 || at > apart.gap.distance || (off - at * along).norm() > width) continue;
      counted[static_cast<std::size_t>(id)] = 1;
      if (++seen_through > kMostSeenThrough) return false;
    }
  }
  return looked_at;
}

/// Label that most of a plane's landmarks in the keyframe have, 0 where fewer than three agree.
int label_of(const Map& map, const Keyframe& keyframe, PlaneId plane) {
  constexpr int kMinAgreed = 3;
  std::map<int, int> votes;
  for (std::size_t k = 0; k < keyframe.landmarks.size() && k < keyframe.labels.size(); ++k) {
    const Landmark* landmark = map.landmarks.find(keyframe.landmarks[k]);
    if (landmark != nullptr && landmark->plane == plane) ++votes[keyframe.labels[k]];
  }
  int label = 0;
  int most = kMinAgreed - 1;
  for (const auto& [candidate, count] : votes) {
    if (candidate > 0 && count > most) {
      label = candidate;
      most = count;
    }
  }
  return label;
}

/// Whether some image's masks tell the two planes apart.
bool are_told_apart(const Map& map, PlaneId a, PlaneId b) {
  for (const Keyframe& keyframe : map.keyframes) {
    const int label_a = label_of(map, keyframe, a);
    const int label_b = label_a > 0 ? label_of(map, keyframe, b) : 0;
    if (label_b > 0 && label_a != label_b) return true;
  }
  return false;
}

/// Pairs (lower id first) of planes that one mask instance shows together.
class SharedMasks {
 public:
  explicit SharedMasks(const KeyframePoints& shown) {
    std::map<std::pair<int, PlaneId>, int> count;
    for (int i = 0; i < shown.size(); ++i) {
      if (shown.label[i] > 0 && shown.plane[i] != kNone) ++count[{shown.label[i], shown.plane[i]}];
    }
    for (const auto& [a, count_a] : count) {
      for (const auto& [b, count_b] : count) {
        if (a.first != b.first || a.second >= b.second) continue;
        if (count_a >= kMinShared && count_b >= kMinShared) pairs_.insert({a.second, b.second});
      }
    }
  }
  bool contain(PlaneId a, PlaneId b) const {
    return pairs_.contains({std::min(a, b), std::max(a, b)});
  }
  /// After `from` has become part of `into`.
  void rename(PlaneId from, PlaneId into) {
    std::set<std::pair<PlaneId, PlaneId>> renamed;
    for (auto [a, b] : pairs_) {
      if (a == from) a = into;
      if (b == from) b = into;
      if (a != b) renamed.insert({std::min(a, b), std::max(a, b)});
    }
    pairs_ = std::move(renamed);
  }

 private:
  static constexpr int kMinShared = 3;
  std::set<std::pair<PlaneId, PlaneId>> pairs_;
};

PlaneSupport joined(const PlaneSupport& a, const PlaneSupport& b) {
  const auto split = [](const auto& vector, const PlaneSupport& support) {
    return vector.begin() + static_cast<std::ptrdiff_t>(support.landmarks.size());
  };
  // Landmarks of both first, then the depth points of both.
  const auto join = [&](const auto& of_a, const auto& of_b) {
    auto result = of_a;
    result.insert(split(result, a), of_b.begin(), split(of_b, b));
    result.insert(result.end(), split(of_b, b), of_b.end());
    return result;
  };
  PlaneSupport result;
  result.landmarks = a.landmarks;
  result.landmarks.insert(result.landmarks.end(), b.landmarks.begin(), b.landmarks.end());
  result.points.positions = join(a.points.positions, b.points.positions);
  result.points.view_from = join(a.points.view_from, b.points.view_from);
  result.points.band = join(a.points.band, b.points.band);
  return result;
}

/// Of a plane's support about a plane that it shares with another. [D] With depth eps_Pi is several
/// times what surfaces are known to, and a table and a cabinet's top that is 4 cm higher would
/// share one.
double most_rms(const Plane& own, const PlaneContext& context) {
  constexpr double kMostGrown = 2.0;
  constexpr double kAlways = 0.2;
  constexpr double kAlwaysStereo = 0.5;
  if (!context.rgbd) return context.scale.eps_pi;
  const double least = context.stereo ? kAlwaysStereo : kAlways;
  return std::clamp(kMostGrown * own.rms, least * context.scale.eps_pi, context.scale.eps_pi);
}

/// Whether one plane explains either support as well as planes must. [D] The smaller one would be
/// lost in the RMS of both; and a plane that was first seen from afar is tilted, so that the
/// distances of the centroids alone say little about parts that lie side by side.
bool fits_jointly(const Plane& a, const Plane& b, const PlaneSupport& support_a,
                  const PlaneSupport& support_b, const PlaneContext& context) {
  Plane trial = a;
  if (!refit_robustly(trial, joined(support_a, support_b), context)) return false;
  const auto explains = [&](const PlaneSupport& support, const Plane& own) {
    update_figures(trial, support, context);
    return trial.rms < most_rms(own, context);
  };
  return explains(support_a, a) && explains(support_b, b);
}

bool same_plane(const Map& map, const Plane& a, const Plane& b, const PlaneSupport& support_a,
                const PlaneSupport& support_b, const SharedMasks& masks,
                const PlaneContext& context) {
  if (support_a.points.size() == 0 || support_b.points.size() == 0) return false;
  if (context.options.merge == PlaneMerge::kPaper) return same_by_paper(a, b, context.scale);
  if (a.normal.dot(b.normal) < kMinCosine) return false;
  const double limit = kMaxCentroidDistance * context.scale.eps_d;
  if (std::abs(a.signed_distance(centroid_of(support_b.points))) > limit) return false;
  if (std::abs(b.signed_distance(centroid_of(support_a.points))) > limit) return false;
  if (!fits_jointly(a, b, support_a, support_b, context)) return false;
  if (masks.contain(a.id, b.id)) return true;
  const Apart apart = how_apart(support_a.points, support_b.points, context.scale);
  return apart.touch() || (context.finished && !are_told_apart(map, a.id, b.id) &&
                           is_bare_between(map, a, apart, context));
}

template <typename T>
void unite(std::vector<T>& into, const std::vector<T>& from) {
  into.insert(into.end(), from.begin(), from.end());
  std::sort(into.begin(), into.end());
  into.erase(std::unique(into.begin(), into.end()), into.end());
}

/// `into` takes over everything of `from`, which is erased. Its frame moves only as a refit moves
/// it.
void take_over(Map& map, PlaneId into, PlaneId from, PlaneSupport& support_into,
               PlaneSupport& support_from, const PlaneContext& context) {
  for (const LandmarkId id : support_from.landmarks) map.landmarks.at(id).plane = into;
  const Plane old = map.planes.at(from);
  map.planes.erase(from);
  Plane& plane = map.planes.at(into);
  plane.depth_points.insert(plane.depth_points.end(), old.depth_points.begin(),
                            old.depth_points.end());
  plane.depth_anchors.insert(plane.depth_anchors.end(), old.depth_anchors.begin(),
                             old.depth_anchors.end());
  unite(plane.observers, old.observers);
  unite(plane.merged_from, old.merged_from);
  unite(plane.merged_from, {from});
  plane.first_frame = std::min(plane.first_frame, old.first_frame);
  plane.stalled_keyframes = 0;
  support_into = joined(support_into, support_from);
  support_from = {};
  if (into < context.fixed_planes) return;
  refit_robustly(plane, support_into, context);
  update_figures(plane, support_into, context);
}

}  // namespace

int merge_planes(Map& map, const PlaneContext& context, const KeyframePoints& shown) {
  SharedMasks masks(shown);
  std::vector<PlaneSupport> support = gather_support(map, context);
  int merged = 0;
  for (PlaneId a = 0; a < map.planes.next_id(); ++a) {
    for (PlaneId b = a + 1; b < map.planes.next_id(); ++b) {
      if (!map.planes.contains(a) || !map.planes.contains(b)) continue;
      if (!same_plane(map, map.planes.at(a), map.planes.at(b), support[a], support[b], masks,
                      context)) {
        continue;
      }
      take_over(map, a, b, support[a], support[b], context);
      masks.rename(b, a);
      ++merged;
      b = a;  // what the merged plane now touches may have been passed
    }
  }
  return merged;
}

}  // namespace planecast::slam
