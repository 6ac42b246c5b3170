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
  throw UserError(object.where + ": model '" + object.model.string() + "' has no animation '" + wanted +
                  "' (it has: " + (list.empty() ? "none" : list) + ")");
}

ModelBox model_box(const render::Model& model) {
  const render::Bounds bounds = render::model_bounds(model);
  return {Eigen::Vector3d(bounds.min.x, bounds.min.y, bounds.min.z),
          Eigen::Vector3d(bounds.max.x, bounds.max.y, bounds.max.z)};
}

}  // namespace

Content load_content(const Reconstruction& reconstruction, const SceneFile& scene, bool causal) {
  Content content;
  std::map<std::string, std::shared_ptr<const render::Model>> loaded;
  for (const SceneObject& object : scene.objects) {
    const std::string path = object.model.string();
    std::shared_ptr<const render::Model>& model = loaded[path];
    if (!model) {
      render::ImportResult result = render::import_gltf(path);
      if (!result.model) throw UserError(path + ": " + result.error);
      model = result.model;
      for (const std::string& warning : result.warnings) {
        content.warnings.push_back(path + ": " + warning);
      }
    }
    const ModelBox box = model_box(*model);
    ContentItem item;
    item.model = model;
    item.placed = place_object(reconstruction, object, box,
                               size_unit(reconstruction, scene, object, causal), causal);
    item.animation = find_animation(*model, object);
    const Eigen::Vector3d sides = box.sizes() * item.placed.scale;
    item.longest_side = sides.maxCoeff();
    item.footprint = 0.5 * (item.placed.hangs ? sides.head<2>().norm()
                                              : Eigen::Vector2d(sides.x(), sides.z()).norm());
    content.items.push_back(item);
  }
  return content;
}

}  // namespace planecast::engine
