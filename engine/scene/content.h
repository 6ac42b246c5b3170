#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/placement.h"
#include "engine/scene/scene_file.h"
#include "render/scene.h"

namespace planecast::engine {

/// A scene file's object with its model loaded and its place found.
struct ContentItem {
  std::shared_ptr<const render::Model> model;
  PlacedObject placed;
  int animation = -1;        ///< -1: rest pose
  double longest_side = 0.0;  ///< world units
  double footprint = 0.0;     ///< radius of a circle about the contact that holds the model's base
};

struct Content {
  std::vector<ContentItem> items;
  std::vector<std::string> warnings;  ///< of the models, each with its file
};

/// Loads every model once and places every object. Throws UserError naming the file (and line) for a
/// model that cannot be read, an animation it has not, and places that are not there.
Content load_content(const Reconstruction& reconstruction, const SceneFile& scene, bool causal);

}  // namespace planecast::engine
