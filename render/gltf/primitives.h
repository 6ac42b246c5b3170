#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/gltf/model.h"
#include "render/gltf/tinygltf_fwd.h"

namespace planecast::render {

/// One primitive as indexed triangles with normals, and tangents where its material has a normal
/// map. Points, lines and primitives without positions or triangles: nothing, with a warning.
/// Throws ImportError for a file that contradicts itself. `materials` ends with the default
/// material.
std::optional<Primitive> import_primitive(const tinygltf::Model& file,
                                          const tinygltf::Primitive& from,
                                          const std::vector<Material>& materials,
                                          std::vector<std::string>& warnings);

}  // namespace planecast::render
