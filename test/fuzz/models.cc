#include "render/gltf/import.h"
#include "test/fuzz/memory_file.h"
#include "test/fuzz/target.h"

namespace planecast::fuzz {

void read_gltf(std::string_view bytes) {
  const render::ImportResult result = render::import_gltf(memory_file(bytes));
  if (result.model == nullptr) return;
  render::model_bounds(*result.model);
  render::describe_model(*result.model);
}

}  // namespace planecast::fuzz
