#pragma once

#include "engine/sequence/synth/room_model.h"

/// What the files of furniture share.
namespace planecast::engine::synth {

/// Small things: never labelled, painted finely.
inline FlatOptions small_things() { return {"none", 800.0F, 0.02F}; }
inline FlatOptions furniture_faces() { return {"", 500.0F, 0.035F}; }

/// A place given in another place's frame.
inline Place on(const Place& place, const Eigen::Vector3d& local, double turn = 0.0) {
  return {place.to_world(local), place.yaw + turn};
}

}  // namespace planecast::engine::synth
