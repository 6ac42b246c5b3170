#include "engine/scene/content.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "engine/scene/keep_apart.h"
#include "engine/scene/metric_scale.h"
#include "engine/user_error.h"
#include "render/gltf/import.h"
#include "render/gltf/model.h"

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

void check_frame(const std::string& where, int frame, int first_frame, int end_frame) {
  if (frame >= first_frame && frame < end_frame) return;
  throw UserError(where + ": frame " + std::to_string(frame) + " is not there (frames: " +
                  std::to_string(first_frame) + " to " + std::to_string(end_frame - 1) + ")");
}

/// The model of an object or its poster's print.
void load_item(const SceneObject& object, ModelShelf& shelf, ContentItem& item) {
  if (object.poster) {
    item.print = std::make_shared<PosterPrint>(*object.poster);
    item.model = item.print->at(object.start_s, object.loop);
  } else {
    item.model = shelf.load(object.model.string());
    item.animation = find_animation(*item.model, object);
  }
  if (item.animation >= 0) {
    item.animation_end_s =
        double{item.model->animations[static_cast<std::size_t>(item.animation)].duration_s};
  }
  const std::filesystem::path& file = object.poster ? object.poster->file : object.model;
  item.file = file.string();
  item.name = object.name.empty() ? file.stem().string() : object.name;
  item.loop = object.loop;
  item.start_s = object.start_s;
}

/// A poster's size is its width, a model's its longest side.
SceneObject with_longest_side(const SceneObject& object, const ContentItem& item) {
  SceneObject result = object;
  if (item.print && result.size) *result.size *= std::max(1.0, item.print->height());
  return result;
}

/// The one of the first `count` objects that this one stands on; -1: none, it has its own place.
int carrier_of(const SceneFile& scene, const SceneObject& object, std::size_t count) {
  const auto* on = std::get_if<ObjectPlace>(&object.place);
  if (on == nullptr) return -1;
  for (std::size_t i = 0; i < count; ++i) {
    if (scene.objects[i].name == on->object) return static_cast<int>(i);
  }
  throw UserError(object.where + ": no object before this one has the name '" + on->object + "'");
}

}  // namespace

void check_content(const SceneFile& scene, int first_frame, int end_frame, ModelShelf& shelf) {
  for (const SceneObject& object : scene.objects) {
    ContentItem item;
    load_item(object, shelf, item);
    if (const auto* place = std::get_if<PixelPlace>(&object.place)) {
      check_frame(object.where, place->frame, first_frame, end_frame);
    }
  }
}

Content load_content(const PlacingWorld& world, const SceneFile& scene) {
  ModelShelf shelf;
  return load_content(world, scene, shelf);
}

Content load_content(const PlacingWorld& world, const SceneFile& scene, ModelShelf& shelf) {
  Content content;
  std::vector<int> carried_by;
  for (const SceneObject& object : scene.objects) {
    ContentItem item;
    load_item(object, shelf, item);
    item.box = model_box(*item.model);
    const SizeUnit unit = size_unit(world, scene, object);
    content.units_per_metre = unit.units_per_metre;
    carried_by.push_back(carrier_of(scene, object, content.items.size()));
    const PlacedObject* below =
        carried_by.back() >= 0 ? &content.items[static_cast<std::size_t>(carried_by.back())].placed
                               : nullptr;
    item.placed = place_object(world, with_longest_side(object, item), item.box, unit, below);
    const Eigen::Vector3d& sides = item.placed.sides;
    item.longest_side = sides.maxCoeff();
    item.footprint = 0.5 * (item.placed.hangs ? sides.head<2>().norm()
                                              : Eigen::Vector2d(sides.x(), sides.z()).norm());
    content.items.push_back(item);
  }
  if (scene.keep_apart) {
    std::vector<Standing> standing;
    for (std::size_t i = 0; i < content.items.size(); ++i) {
      standing.push_back({&content.items[i].placed, carried_by[i]});
    }
    keep_apart(standing);
  }
  content.warnings = shelf.warnings();
  return content;
}

std::vector<ObjectRecord> object_records(const Content& content,
                                         const Reconstruction& reconstruction) {
  std::vector<ObjectRecord> records;
  for (const ContentItem& item : content.items) {
    const auto world_from_model = item.placed.world_from_model(reconstruction.planes);
    if (!world_from_model) continue;
    records.push_back({item.name, item.file, item.placed.anchor.plane_id, *world_from_model,
                       item.box, item.model});
  }
  return records;
}

}  // namespace planecast::engine
