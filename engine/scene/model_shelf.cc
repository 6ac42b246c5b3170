#include "engine/scene/model_shelf.h"

#include "engine/user_error.h"
#include "render/gltf/import.h"

namespace planecast::engine {

const std::shared_ptr<const render::Model>& ModelShelf::load(const std::string& path) {
  std::shared_ptr<const render::Model>& model = models_[path];
  if (model) return model;
  render::ImportResult result = render::import_gltf(path);
  if (!result.model) throw UserError(path + ": " + result.error);
  for (const std::string& warning : result.warnings) warnings_.push_back(path + ": " + warning);
  model = result.model;
  return model;
}

}  // namespace planecast::engine
