#include "slam/stages/stereo_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "slam/stages/plane_steps.h"

namespace planecast::slam {

namespace {

/// Those that together show what all do, in the order of their ids.
std::vector<KeyframeId> reference_keyframes(const Map& map, const StereoPlaneOptions& options) {
  const double least_cosine = std::cos(options.min_turn_deg * std::numbers::pi / 180.0);
  std::vector<const Keyframe*> chosen;
  std::vector<KeyframeId> result;
  for (const Keyframe& keyframe : map.keyframes) {
    const double near = options.min_distance * map.median_depth(keyframe.id);
    const bool shown = std::any_of(chosen.begin(), chosen.end(), [&](const Keyframe* other) {
      return (other->centre_world() - keyframe.centre_world()).norm() < near &&
             other->cam_from_world.linear().row(2).dot(keyframe.cam_from_world.linear().row(2)) >
                 least_cosine;
    });
    if (shown || keyframe.pyramid == nullptr) continue;
    chosen.push_back(&keyframe);
    result.push_back(keyframe.id);
  }
  return result;
}

void forget_weak_planes(Map& map) {
  std::vector<PlaneId> weak;
  for (const Plane& plane : map.planes) {
    if (plane.weak) weak.push_back(plane.id);
  }
  for (const PlaneId id : weak) erase_plane(map, id);
}

/// How the surface about the planes faces that were there before.
class FacingCounts {
 public:
  explicit FacingCounts(PlaneId planes) : counts_(static_cast<std::size_t>(planes)) {}

  /// Samples of depth in the box and slab of each plane.
  void add(const Map& map, const KeyframePoints& shown, const std::vector<GrowingPlane>& growing,
           double eps_d) {
    for (const GrowingPlane& one : growing) {
      if (static_cast<std::size_t>(one.plane) >= counts_.size()) continue;
      const Plane& plane = map.planes.at(one.plane);
      Count& count = counts_[static_cast<std::size_t>(one.plane)];
      for (int i = 0; i < shown.size(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (shown.landmark[at] != kNone || shown.normal[at].isZero()) continue;
        const Eigen::Vector3d& point = shown.points.positions[at];
        if ((point.array() < one.low.array() - eps_d).any() ||
            (point.array() > one.high.array() + eps_d).any() ||
            std::abs(plane.signed_distance(point)) > shown.points.band[at] * eps_d) {
          continue;
        }
        ++count.asked;
        count.facing += shown.may_face(i, plane.normal);
      }
    }
  }

  /// True planes of the built-in scenes and of an office have shares of 0.58 and more, slabs 0 to
  /// 0.34.
  void weaken_slabs(Map& map) const {
    constexpr int kFewest = 30;
    constexpr double kLeastFacing = 0.45;
    for (std::size_t id = 0; id < counts_.size(); ++id) {
      Plane* plane = map.planes.find(static_cast<PlaneId>(id));
      if (plane == nullptr || counts_[id].asked < kFewest) continue;
      if (counts_[id].facing < kLeastFacing * counts_[id].asked) plane->weak = true;
    }
  }

 private:
  struct Count {
    int asked = 0;
    int facing = 0;
  };
  std::vector<Count> counts_;  ///< by plane
};

/// New planes, and old ones that few landmarks hold: most of these are tilted by degrees. A new one
/// of which nothing is found again stays weak: content on it would slide.
void refit_vague_planes(Map& map, const PlaneContext& context,
                        const PlaneByPatchesOptions& options) {
  constexpr std::size_t kWellKnown = 100;  // landmarks
  constexpr std::size_t kFewestDepths = 60;
  const std::vector<PlaneSupport> support = gather_support(map, context);
  for (Plane& plane : map.planes) {
    const PlaneSupport& own = support[static_cast<std::size_t>(plane.id)];
    if (plane.depth_points.size() < kFewestDepths) continue;
    const bool is_old = plane.id < context.fixed_planes;
    if (is_old && own.landmarks.size() >= kWellKnown) continue;
    if (refit_by_patches(map, plane, own, context, options)) continue;
    if (is_old) {
      refit_robustly(plane, own, context);
    } else {
      plane.weak = true;
    }
  }
}

/// What local mapping does with a keyframe that has depth, but for what moves landmarks.
void search(Map& map, KeyframeId keyframe, const PlaneContext& context, FacingCounts& facing) {
  KeyframePoints shown = gather_points(map, keyframe, context);
  std::vector<GrowingPlane> growing;
  prepare_growth(map, context, growing);
  facing.add(map, shown, growing, context.scale.eps_d);
  expand_planes(map, keyframe, context, shown, growing);
  find_planes(map, keyframe, context, shown);
  prepare_growth(map, context, growing);
  expand_planes(map, keyframe, context, shown, growing);
  merge_planes(map, context, shown);
  reestimate_planes(map, keyframe, context);
  drop_weak_planes(map, context);
}

/// Planes that were there before stay as large as they were: what is smoothed goes on over the edge
/// of a desk where what is beside it has no texture.
class Extents {
 public:
  explicit Extents(const Map& map) {
    for (const Plane& plane : map.planes) {
      saved_.push_back({plane.id, plane.depth_points, plane.depth_anchors});
    }
  }
  void restore(Map& map) const {
    for (const Saved& saved : saved_) {
      Plane& plane = map.planes.at(saved.plane);
      plane.depth_points = saved.points;
      plane.depth_anchors = saved.anchors;
    }
  }

 private:
  struct Saved {
    PlaneId plane = kNone;
    std::vector<Eigen::Vector3d> points;
    std::vector<DepthAnchor> anchors;
  };
  std::vector<Saved> saved_;
};

/// Figures of what supports the planes now; whether they are weak is known.
void count_support(Map& map, const PlaneContext& context) {
  const std::vector<PlaneSupport> support = gather_support(map, context);
  for (Plane& plane : map.planes) {
    const bool weak = plane.weak;
    update_figures(plane, support[static_cast<std::size_t>(plane.id)], context);
    plane.weak = weak;
  }
}

}  // namespace

void find_stereo_planes(Map& map, PlaneContext context, const StereoPlaneOptions& options) {
  forget_weak_planes(map);
  context.rgbd = true;
  context.stereo = true;
  context.fixed_planes = map.planes.next_id();
  const Extents extents(map);
  FacingCounts facing(map.planes.next_id());
  const StereoDepth stereo(context.camera, options.depth);
  for (const KeyframeId id : reference_keyframes(map, options)) {
    Keyframe& keyframe = map.keyframes.at(id);
    keyframe.depth = stereo.of(map, id);
    if (keyframe.depth.empty()) continue;
    if (!keyframe.coarse_labels.empty()) {
      cv::resize(keyframe.coarse_labels, keyframe.label_image, keyframe.depth.size(), 0, 0,
                 cv::INTER_NEAREST);
    }
    search(map, id, context, facing);
    keyframe.depth.release();
    keyframe.label_image.release();
  }
  context.finished = true;
  merge_planes(map, context, {});
  settle_planes(map, context);
  refit_vague_planes(map, context, options.patches);
  extents.restore(map);
  facing.weaken_slabs(map);
  count_support(map, context);
}

}  // namespace planecast::slam
