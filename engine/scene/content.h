#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/pipeline/reconstruction.h"
#include "engine/scene/model_shelf.h"
#include "engine/scene/object_record.h"
#include "engine/scene/placement.h"
#include "engine/scene/poster.h"
#include "engine/scene/scene_file.h"
#include "render/scene.h"

namespace planecast::engine {

/// A scene file's object with its model loaded and its place found.
struct ContentItem {
  std::string name;  ///< the object's, or its file's
  std::string file;
  std::shared_ptr<const render::Model> model;
  std::shared_ptr<PosterPrint> print;  ///< of a poster: its model changes; else null
  PlacedObject placed;
  ModelBox box;
  int animation = -1;  ///< -1: rest pose
  double animation_end_s = 0.0;
  bool loop = true;
  double start_s = 0.0;
  double longest_side = 0.0;  ///< world units
  double footprint = 0.0;     ///< radius of a circle about the contact that holds the model's base
};

struct Content {
  std::vector<ContentItem> items;
  double units_per_metre = 0.0;       ///< as the sizes count; 0: the map has no scale
  std::vector<std::string> warnings;  ///< of the models, each with its file
};

/// What can be known before tracking: every model is readable and has its animation, every frame
/// that is named lies in first..end-1. The models stay on the shelf. Throws UserError like
/// load_content.
void check_content(const SceneFile& scene, int first_frame, int end_frame, ModelShelf& shelf);

/// Loads every model once and places every object, later ones beside earlier ones where they would
/// overlap (unless the scene says otherwise). Throws UserError naming the file (and line) for a
/// model that cannot be read, an animation it has not, and places that are not there.
Content load_content(const PlacingWorld& world, const SceneFile& scene);
/// The same; models on the shelf are not read again.
Content load_content(const PlacingWorld& world, const SceneFile& scene, ModelShelf& shelf);

/// Where the objects are. Those whose plane is gone are left out.
std::vector<ObjectRecord> object_records(const Content& content,
                                         const Reconstruction& reconstruction);

}  // namespace planecast::engine
