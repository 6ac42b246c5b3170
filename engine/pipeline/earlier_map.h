#pragma once

#include <memory>
#include <string>

#include "engine/sequence/sequence.h"
#include "slam/data/camera.h"
#include "slam/data/map.h"

namespace planecast::engine {

/// What an earlier run left behind, for this sequence to go on from.
struct EarlierMap {
  slam::Camera camera;
  bool metric = false;
  std::shared_ptr<const slam::Map> map;  ///< null: there is none
};

/// Reads the map of a reconstruction folder for `sequence`; an empty `folder` gives the sequence's
/// own camera and no map. Where both cameras are guesses the one that the map has refined counts.
/// Throws UserError where there is no sound map, or one of another camera or without the metric
/// scale that depth (`rgbd`) needs.
EarlierMap read_earlier_map(const std::string& folder, const Sequence& sequence, bool rgbd);

}  // namespace planecast::engine
