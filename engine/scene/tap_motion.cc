#include "engine/scene/tap_motion.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace planecast::engine {
namespace {

/// Rays flatter than about two degrees meet a plane nowhere in particular.
constexpr double kLeastSlope = 0.035;

const FrameRecord* find_frame(const Reconstruction& reconstruction, int frame_index) {
  const auto found = std::ranges::find(reconstruction.frames, frame_index, &FrameRecord::index);
  return found == reconstruction.frames.end() ? nullptr : &*found;
}

/// Frame of the last keyframe that was known at the frame, is not later than it and lasted.
std::optional<int> carrier_of(const Reconstruction& reconstruction, int frame_index) {
  std::optional<int> carrier;
  for (const MapChange& change : reconstruction.map_changes) {
    if (change.frame_index > frame_index) break;
    for (const KnownKeyframe& known : change.keyframes) {
      const bool lasts =
          std::ranges::find(reconstruction.keyframes, known.frame_index,
                            &KeyframeRecord::frame_index) != reconstruction.keyframes.end();
      if (lasts && known.frame_index <= frame_index) {
        carrier = std::max(carrier.value_or(known.frame_index), known.frame_index);
      }
    }
  }
  return carrier;
}

/// Where the ray meets the plane z = 0 of the frame; nothing where it hardly does.
std::optional<Eigen::Vector3d> meet(const slam::Pose& world_from_plane,
                                    const slam::Pose& world_from_cam,
                                    const Eigen::Vector3d& direction_cam) {
  const slam::Pose plane_from_cam = world_from_plane.inverse() * world_from_cam;
  const Eigen::Vector3d from = plane_from_cam.translation();
  const Eigen::Vector3d along = plane_from_cam.linear() * direction_cam.normalized();
  if (from.z() <= 0.0 || along.z() > -kLeastSlope) return std::nullopt;
  return from - from.z() / along.z() * along;
}

}  // namespace

std::vector<std::optional<slam::Pose>> frame_poses_by_change(const Reconstruction& reconstruction,
                                                             int frame_index) {
  const std::vector<MapChange>& changes = reconstruction.map_changes;
  std::vector<std::optional<slam::Pose>> poses(changes.size());
  const FrameRecord* frame = find_frame(reconstruction, frame_index);
  const std::optional<int> carrier = carrier_of(reconstruction, frame_index);
  if (frame == nullptr || !frame->causal_world_from_cam || !carrier) return poses;
  std::optional<slam::Pose> carrier_then;  ///< at the frame
  std::optional<slam::Pose> carrier_now;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto known =
        std::ranges::find(changes[i].keyframes, *carrier, &KnownKeyframe::frame_index);
    if (known != changes[i].keyframes.end()) carrier_now = known->world_from_cam;
    if (changes[i].frame_index <= frame_index) {
      carrier_then = carrier_now;
      poses[i] = *frame->causal_world_from_cam;
    } else {
      poses[i] = *carrier_now * carrier_then->inverse() * *frame->causal_world_from_cam;
    }
  }
  return poses;
}

void follow_tap(const Reconstruction& reconstruction, const Tap& tap,
                std::vector<std::optional<slam::Pose>>& world_from_plane) {
  const std::vector<MapChange>& changes = reconstruction.map_changes;
  const auto frame_poses = frame_poses_by_change(reconstruction, tap.frame_index);
  std::optional<Eigen::Vector3d> tapped;  ///< in the plane's own frame, at the tap
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < world_from_plane.size(); ++i) {
    if (!world_from_plane[i]) continue;
    const auto met = frame_poses[i] ? meet(*world_from_plane[i], *frame_poses[i], tap.direction_cam)
                                    : std::nullopt;
    if (met && (!tapped || changes[i].frame_index <= tap.frame_index)) tapped = met;
    if (met) shift = *met - *tapped;
    world_from_plane[i]->translate(shift);
  }
}

}  // namespace planecast::engine
