#include "engine/scene/plane_motion.h"

#include <algorithm>

#include "engine/scene/plane_outline.h"

namespace planecast::engine {
namespace {

const KnownPlane* find_known(const MapChange& change, int id) {
  const auto found = std::ranges::find(change.planes, id, &KnownPlane::id);
  return found == change.planes.end() ? nullptr : &*found;
}

/// What stood for a plane of the finished map at a change: itself, or what was merged into it.
const KnownPlane* stand_in(const MapChange& change, const PlaneRecord& plane) {
  if (const KnownPlane* itself = find_known(change, plane.id)) return itself;
  for (const int id : plane.merged_from) {
    if (const KnownPlane* part = find_known(change, id)) return part;
  }
  return nullptr;
}

/// The plane's own frame after each change. Where another plane stood for it, that one's frame
/// times what ties the two frames together when it hands over, so that content re-expressed at the
/// merge does not move.
std::vector<std::optional<slam::Pose>> poses_by_change(const std::vector<MapChange>& changes,
                                                       const PlaneRecord& plane) {
  std::vector<std::optional<slam::Pose>> poses(changes.size());
  slam::Pose stand_in_from_plane = slam::Pose::Identity();
  int last_id = plane.id;
  std::size_t last = changes.size();
  for (std::size_t i = changes.size(); i-- > 0;) {
    const KnownPlane* known = stand_in(changes[i], plane);
    if (known == nullptr) continue;
    if (known->id != last_id) {
      // What the final refinement moved is not known: without a later change it counts as nothing.
      slam::Pose new_from_this = slam::Pose::Identity();
      for (std::size_t k = i + 1; k <= last && k < changes.size(); ++k) {
        new_from_this = changes[k].new_from_old_world * new_from_this;
      }
      const slam::Pose later = last < changes.size() ? *poses[last] : plane.world_from_plane();
      stand_in_from_plane = known->world_from_plane.inverse() * new_from_this.inverse() * later;
    }
    poses[i] = known->world_from_plane * stand_in_from_plane;
    last = i;
    last_id = known->id;
  }
  return poses;
}

void move_plane(PlaneRecord& plane, const slam::Pose& world_from_plane) {
  const slam::Pose motion = world_from_plane * plane.world_from_plane().inverse();
  plane.normal = motion.linear() * plane.normal;
  plane.x_axis = motion.linear() * plane.x_axis;
  plane.origin = motion * plane.origin;
  plane.offset = -plane.normal.dot(plane.origin);
  for (Eigen::Vector3d& corner : plane.polygon) corner = motion * corner;
  for (auto& hole : plane.holes) {
    for (Eigen::Vector3d& corner : hole) corner = motion * corner;
  }
}

/// From one place to another with neither start nor stop being felt.
double smooth_step(double t) { return t * t * (3.0 - 2.0 * t); }

/// Content carried along with every change and eased to where it belongs.
std::vector<std::optional<slam::Pose>> eased(
    const std::vector<MapChange>& changes, const std::vector<std::optional<slam::Pose>>& by_change,
    int first_frame, std::size_t frames, int ease_frames) {
  std::vector<std::optional<slam::Pose>> shown(frames);
  std::optional<slam::Pose> from;
  std::optional<slam::Pose> target;
  int step = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    while (next < changes.size() &&
           changes[next].frame_index <= first_frame + static_cast<int>(i)) {
      const bool was_shown = i > 0 && shown[i - 1];
      from.reset();
      if (was_shown) from = changes[next].new_from_old_world * *shown[i - 1];
      // A plane that is in doubt for a while moves with the map.
      if (by_change[next] || !target) {
        target = by_change[next];
      } else {
        target = changes[next].new_from_old_world * *target;
      }
      step = 0;
      ++next;
    }
    if (!target) continue;
    const bool arrived = !from || step >= ease_frames;
    shown[i] = arrived ? *target : between(*from, *target, smooth_step(1.0 * step / ease_frames));
    ++step;
  }
  return shown;
}

}  // namespace

slam::Pose between(const slam::Pose& from, const slam::Pose& to, double t) {
  slam::Pose pose = slam::Pose::Identity();
  pose.linear() = Eigen::Quaterniond(from.linear())
                      .slerp(t, Eigen::Quaterniond(to.linear()))
                      .normalized()
                      .toRotationMatrix();
  pose.translation() = (1.0 - t) * from.translation() + t * to.translation();
  return pose;
}

std::vector<PlaneRecord> planes_as_known(const Reconstruction& reconstruction, int frame_index) {
  const std::vector<MapChange>& changes = reconstruction.map_changes;
  std::vector<PlaneRecord> planes = reconstruction.planes;
  for (PlaneRecord& plane : planes) {
    const auto poses = poses_by_change(changes, plane);
    const slam::Pose* known = nullptr;
    for (std::size_t i = 0; i < changes.size(); ++i) {
      if (known != nullptr && changes[i].frame_index > frame_index) break;
      if (poses[i]) known = &*poses[i];
    }
    if (known != nullptr) move_plane(plane, *known);
  }
  return planes;
}

PlaneMotion::PlaneMotion(const Reconstruction& reconstruction, int ease_frames)
    : reconstruction_(&reconstruction), ease_frames_(ease_frames) {
  if (reconstruction.map_changes.empty() || reconstruction.frames.empty()) return;
  first_frame_ = reconstruction.frames.front().index;
  for (const PlaneRecord& plane : reconstruction.planes) {
    const auto by_change = poses_by_change(reconstruction.map_changes, plane);
    poses_[plane.id] = eased(reconstruction.map_changes, by_change, first_frame_,
                             reconstruction.frames.size(), ease_frames);
  }
}

std::vector<std::optional<slam::Pose>> PlaneMotion::world_from_plane_under(const Tap& tap,
                                                                           int plane_id) const {
  const std::size_t frames = reconstruction_->frames.size();
  const PlaneRecord* plane = find_plane(reconstruction_->planes, plane_id);
  if (plane == nullptr) return std::vector<std::optional<slam::Pose>>(frames);
  if (poses_.empty()) {
    return std::vector<std::optional<slam::Pose>>(frames, plane->world_from_plane());
  }
  auto by_change = poses_by_change(reconstruction_->map_changes, *plane);
  follow_tap(*reconstruction_, tap, by_change);
  return eased(reconstruction_->map_changes, by_change, first_frame_, frames, ease_frames_);
}

std::optional<slam::Pose> PlaneMotion::world_from_plane(int plane_id, int frame_index) const {
  const PlaneRecord* plane = find_plane(reconstruction_->planes, plane_id);
  if (plane == nullptr) return std::nullopt;
  if (poses_.empty()) return plane->world_from_plane();
  const auto index = static_cast<std::size_t>(frame_index - first_frame_);
  const auto& poses = poses_.at(plane->id);
  return frame_index >= first_frame_ && index < poses.size() ? poses[index] : std::nullopt;
}

}  // namespace planecast::engine
