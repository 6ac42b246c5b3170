#pragma once

#include <string>
#include <vector>

#include "render/gltf/model.h"
#include "render/gltf/tinygltf_fwd.h"

namespace planecast::render {

/// Images as 8 bits, textures, and materials with one default material after the file's own. A
/// texture that cannot be used is left out with a warning. Throws ImportError for indices out of
/// range.
void import_materials(const tinygltf::Model& file, Model& model,
                      std::vector<std::string>& warnings);

}  // namespace planecast::render
