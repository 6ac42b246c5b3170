#pragma once

#include <filesystem>
#include <string>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/scene_file.h"

namespace planecast::engine {

struct DefaultSceneOptions {
  std::filesystem::path standing_model;  ///< for planes that things stand on
  std::string standing_animation;        ///< of it; empty: rest pose
  std::filesystem::path hanging_model;   ///< for walls
  double size_of_view = 0.3;             ///< longest side, of the distance it is usually seen from
  double size_of_patch = 0.6;  ///< at most this share of the free circle's diameter on the plane
  int sampled_frames = 80;     ///< frames whose view votes for places
};

/// One object where the camera looks, for runs without a scene file: rays through the middle of
/// sampled frames vote for the plane they meet (planes that face up count most, then walls) and for
/// the place on it; the place must lie inside the outline and, on a table, clear of points that
/// stand above it. Throws UserError when there is no plane to put anything on.
SceneFile default_scene(const Reconstruction& reconstruction, const DefaultSceneOptions& options);

/// The options with the built-in models.
DefaultSceneOptions builtin_models();

}  // namespace planecast::engine
