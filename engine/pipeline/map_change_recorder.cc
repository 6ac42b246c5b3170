#include "engine/pipeline/map_change_recorder.h"

#include <algorithm>
#include <span>
#include <utility>

namespace planecast::engine {
namespace {

std::vector<KnownPlane> known_planes(const slam::Map& map) {
  std::vector<KnownPlane> planes;
  for (const slam::Plane& plane : map.planes) {
    if (!plane.weak) planes.push_back({plane.id, plane.world_from_plane()});
  }
  return planes;
}

/// Whether a map change did anything to what stands on the planes.
bool changed(std::span<const KnownPlane> before, const MapChange& change) {
  const bool same_planes =
      std::ranges::equal(before, change.planes, [](const KnownPlane& a, const KnownPlane& b) {
        return a.id == b.id && a.world_from_plane.matrix() == b.world_from_plane.matrix();
      });
  if (!same_planes) return true;
  constexpr double kRounding = 1e-9;
  return !before.empty() && !change.new_from_old_world.isApprox(slam::Pose::Identity(), kRounding);
}

}  // namespace

void MapChangeRecorder::record(const slam::Map& map, int frame_index,
                               const slam::Pose& new_from_old_world) {
  MapChange change;
  change.frame_index = frame_index;
  change.planes = known_planes(map);
  change.new_from_old_world = new_from_old_world;
  std::span<const KnownPlane> before;
  if (!changes_.empty()) before = changes_.back().planes;
  if (!changed(before, change)) return;
  change.keyframes = take_moved_keyframes(map);
  changes_.push_back(std::move(change));
}

void MapChangeRecorder::clear() {
  changes_.clear();
  keyframe_poses_.clear();
}

/// Keyframes that are new or have another pose than at the change before.
std::vector<KnownKeyframe> MapChangeRecorder::take_moved_keyframes(const slam::Map& map) {
  std::vector<KnownKeyframe> moved;
  for (const slam::Keyframe& keyframe : map.keyframes) {
    if (keyframe.id < first_) continue;
    const auto [known, is_new] = keyframe_poses_.try_emplace(keyframe.id, keyframe.cam_from_world);
    if (!is_new && known->second.matrix() == keyframe.cam_from_world.matrix()) continue;
    known->second = keyframe.cam_from_world;
    moved.push_back({keyframe.frame_index, keyframe.cam_from_world.inverse()});
  }
  return moved;
}

}  // namespace planecast::engine
