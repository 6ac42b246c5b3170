#pragma once

#include <map>
#include <optional>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/tap_motion.h"

namespace planecast::engine {

/// Where the planes stood at a frame of the first pass: the finished map's planes, each moved
/// rigidly to its pose of that time. A plane that was not known yet stands where it first appeared;
/// one that came to its name by a merge follows what it was merged from before. Without a record of
/// the first pass: the finished map's planes.
std::vector<PlaneRecord> planes_as_known(const Reconstruction& reconstruction, int frame_index);

/// The planes' own frames over the frames of a causal run. When the map changes, what stands on a
/// plane is first carried along with the camera, so that it stays where it is in the picture, and
/// then moves to its new place over `ease_frames` frames (0: at once).
class PlaneMotion {
 public:
  PlaneMotion(const Reconstruction& reconstruction, int ease_frames);

  /// World from the plane's frame as content is drawn at that frame; nothing where the plane was
  /// not known. `plane_id` is one of the finished map's, or one merged into those.
  std::optional<slam::Pose> world_from_plane(int plane_id, int frame_index) const;
  /// The same by position of the frame in the reconstruction, for content that was put there by a
  /// tap and stays on its ray (follow_tap()).
  std::vector<std::optional<slam::Pose>> world_from_plane_under(const Tap& tap, int plane_id) const;

 private:
  const Reconstruction* reconstruction_;
  int ease_frames_;
  int first_frame_ = 0;
  std::map<int, std::vector<std::optional<slam::Pose>>> poses_;  ///< by plane, then by frame
};

/// `t` of the way from one pose to the other: places along the line, turns along the shortest arc.
slam::Pose between(const slam::Pose& from, const slam::Pose& to, double t);

}  // namespace planecast::engine
