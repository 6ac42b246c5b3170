#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/sequence/synth/camera_effects.h"
#include "engine/sequence/synth/camera_path.h"
#include "engine/sequence/synth/room_model.h"

namespace planecast::engine::synth {

/// A place and the way a camera goes through it.
struct Scene {
  RoomModel model;
  CameraPath path;
  std::vector<std::pair<double, double>> covered_s;  ///< times while a hand hides the lens
  EffectOptions effects;                             ///< of the camera, where they are wanted
};

/// All names, the demo's first.
std::vector<std::string> scene_names();
std::optional<Scene> make_scene(const std::string& name, std::uint64_t seed);

}  // namespace planecast::engine::synth
