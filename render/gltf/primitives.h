#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/gltf/model.h"
#include "render/gltf/tinygltf_fwd.h"

namespace planecast::render {

/// One primitive as a list of triangles, lines or points; triangles get normals, and tangents where
/// the material (of the variant, -1: none) has a normal map. Nothing for primitives without
/// positions (with a warning) or without a whole triangle, line or point.
/// Throws ImportError for a file that contradicts itself. `materials` ends with the default
/// material.
std::optional<Primitive> import_primitive(const tinygltf::Model& file,
                                          const tinygltf::Primitive& from,
                                          const std::vector<Material>& materials, int variant,
                                          std::vector<std::string>& warnings);

}  // namespace planecast::render
