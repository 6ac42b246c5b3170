#pragma once

#include <map>
#include <utility>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "slam/data/map.h"

namespace planecast::engine {

/// Keeps what the changes of the map did to its planes, its keyframes and the camera, so that
/// causal content can be drawn as it was known at each frame.
class MapChangeRecorder {
 public:
  /// Keyframes before `first` came with an earlier map and are not recorded.
  void start_at(slam::KeyframeId first) { first_ = first; }

  /// To be called after each frame. `new_from_old_world` is what the map's change did to the
  /// frame before, (4,4) rigid.
  void record(const slam::Map& map, int frame_index, const slam::Pose& new_from_old_world);
  /// The map was thrown away.
  void clear();
  std::vector<MapChange> take() { return std::move(changes_); }

 private:
  std::vector<KnownKeyframe> take_moved_keyframes(const slam::Map& map);

  slam::KeyframeId first_ = 0;
  std::vector<MapChange> changes_;
  std::map<slam::KeyframeId, slam::Pose> keyframe_poses_;  ///< as of the last of the changes
};

}  // namespace planecast::engine
