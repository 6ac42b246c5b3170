#include "engine/scene/content.h"

#include <algorithm>
#include <map>

#include "engine/scene/metric_scale.h"
#include "engine/user_error.h"
#include "render/gltf/import.h"

namespace planecast::engine {
namespace {

int find_animation(const render::Model& model, const SceneObject& object) {
  if (object.animation.empty() && !object.animation_index) return -1;
  const std::vector<std::string> names = render::animation_names(model);
  if (object.animation_index && *object.animation_index < static_cast<int>(names.size())) {
    return *object.animation_index;
  }
  const auto named = std::ranges::find(names, object.animation);
  if (!object.animation.empty() && named != names.end()) {
    return static_cast<int>(named - names.begin());
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const std::string wanted =
      object.animation_index ? std::to_string(*object.animation_index) : object.animation;
  throw UserError(object.where + ": model '" + object.model.string() + "' has no animation '" +
                  wanted + "' (it has: " + (list.empty() ? "none" : list) + ")");
}

ModelBox model_box(const render::Model& model) {
  const render::Bounds bounds = render::model_bounds(model);
  return {Eigen::Vector3d(bounds.min.x, bounds.min.y, bounds.min.z),
          Eigen::Vector3d(bounds.max.x, bounds.max.y, bounds.max.z)};
}

}  // namespace

void check_content(const SceneFile& scene, int first_frame, int end_frame) {
  ModelShelf shelf;
  for (const SceneObject& object : scene.objects) {
    find_animation(*shelf.load(object.model.string()), object);
    const auto* place = std::get_if<PixelPlace>(&object.place);
    if (place != nullptr && (place->frame < first_frame || place->frame >= end_frame)) {
      throw UserError(object.where + ": frame " + std::to_string(place->frame) +
                      " is not there (frames: " + std::to_string(first_frame) + " to " +
                      std::to_string(end_frame - 1) + ")");
    }
  }
}

Content load_content(const Reconstruction& reconstruction, const SceneFile& scene, bool causal) {
  ModelShelf shelf;
  return load_content(reconstruction, scene, causal, shelf);
}

Content load_content(const Reconstruction& reconstruction, const SceneFile& scene, bool causal,
                     ModelShelf& shelf) {
  Content content;
  for (const SceneObject& object : scene.objects) {
    ContentItem item;
    item.model = shelf.load(object.model.string());
    item.box = model_box(*item.model);
    item.placed = place_object(reconstruction, object, item.box,
                               size_unit(reconstruction, scene, object, causal), causal);
    item.animation = find_animation(*item.model, object);
    const Eigen::Vector3d sides = item.box.sizes() * item.placed.scale;
    item.longest_side = sides.maxCoeff();
    item.footprint = 0.5 * (item.placed.hangs ? sides.head<2>().norm()
                                              : Eigen::Vector2d(sides.x(), sides.z()).norm());
    content.items.push_back(item);
  }
  content.warnings = shelf.warnings();
  return content;
}

std::vector<ObjectRecord> object_records(const Content& content, const SceneFile& scene,
                                         const Reconstruction& reconstruction) {
  std::vector<ObjectRecord> records;
  for (std::size_t i = 0; i < content.items.size(); ++i) {
    const ContentItem& item = content.items[i];
    const auto world_from_model = item.placed.world_from_model(reconstruction.planes);
    if (!world_from_model) continue;
    records.push_back({scene.objects[i].model.stem().string(), item.placed.anchor.plane_id,
                       *world_from_model, item.box, item.model});
  }
  return records;
}

}  // namespace planecast::engine
