#pragma once

#include <utility>
#include <vector>

#include "slam/data/keyframe.h"
#include "slam/data/landmark.h"
#include "slam/data/plane.h"
#include "slam/data/slot_store.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// Keyframes, landmarks and planes, by value: a copy is an independent snapshot. Invariants, kept
/// by the functions below: keyframe.landmarks[k] == l exactly where l's observations hold
/// (keyframe, k); a landmark sees a keyframe at most once; observations ascend by keyframe.
class Map {
 public:
  SlotStore<Keyframe> keyframes;
  SlotStore<Landmark> landmarks;
  SlotStore<Plane> planes;
  /// Pairs of keyframes that a closed loop has tied together: edges of the essential graph. Both
  /// alive.
  std::vector<std::pair<KeyframeId, KeyframeId>> loop_edges;

  void add_observation(LandmarkId landmark, KeyframeId keyframe, int keypoint);
  /// Removes it; a landmark left with fewer than `min_observations` is erased too.
  void remove_observation(LandmarkId landmark, KeyframeId keyframe, int min_observations = 2);
  void erase_landmark(LandmarkId landmark);
  /// Removes the keyframe and its observations and hangs its children below its parent; its pose
  /// relative to the parent is remembered for keyframe_pose().
  void erase_keyframe(KeyframeId keyframe);
  /// Moves the observations of `from` to `to` (where `to` is not seen yet) and erases `from`, which
  /// is found as `to` from then on by resolve().
  void replace_landmark(LandmarkId from, LandmarkId to);
  /// The living landmark that `id` has become, or kNone.
  LandmarkId resolve(LandmarkId id) const;

  /// cam_from_world of a living keyframe, or of an erased one by way of its ancestors.
  Pose keyframe_pose(KeyframeId keyframe) const;
  /// The keyframe itself, or the nearest ancestor that was not erased.
  KeyframeId living_ancestor(KeyframeId keyframe) const;
  /// Keyframe::unit, of an erased keyframe by way of its ancestors.
  double keyframe_unit(KeyframeId keyframe) const;
  /// A camera relative to a keyframe, in that keyframe's own units, and back: what is kept relative
  /// stays right when a closed loop moves and scales the keyframe.
  Pose relative_to_keyframe(const Pose& cam_from_world, KeyframeId keyframe) const;
  Pose from_keyframe(const Pose& cam_from_keyframe, KeyframeId keyframe) const;

  /// Keyframes that share at least `min_shared` landmarks with `keyframe`, most first, ties by id.
  std::vector<std::pair<KeyframeId, int>> covisible(KeyframeId keyframe, int min_shared = 15) const;
  /// Descriptor, mean viewing direction and distance range from the observations.
  void update_landmark_summary(LandmarkId landmark, const ScaleLevels& levels);
  /// Landmarks that own the plane, ascending.
  std::vector<LandmarkId> landmarks_of(PlaneId plane) const;
  /// Depths of the keyframe's landmarks in its camera, in the order of its keypoints.
  std::vector<double> landmark_depths(KeyframeId keyframe) const;
  /// Median depth of the keyframe's landmarks in its camera; 0 when it has none.
  double median_depth(KeyframeId keyframe) const;
  /// Applies new_world_from_old_world and a scale to everything: x' = scale * R x + t.
  void transform(double scale, const Pose& new_from_old);

 private:
  friend class MapArchive;
  struct ErasedKeyframe {
    KeyframeId id;
    KeyframeId parent;
    Pose cam_from_parent;    ///< in the parent's units
    double unit_per_parent;  ///< its unit over the parent's
  };
  const ErasedKeyframe* find_erased(KeyframeId keyframe) const;

  std::vector<std::pair<LandmarkId, LandmarkId>> replaced_;  ///< ascending by first
  std::vector<ErasedKeyframe> erased_keyframes_;             ///< ascending by id
};

}  // namespace planecast::slam
