#pragma once

#include <string>
#include <vector>

#include "render/gltf/model.h"
#include "render/gltf/tinygltf_fwd.h"

namespace planecast::render {

/// Textures (the model's images must be there) and materials with one default material after the
/// file's own. A texture that cannot be used is left out with a warning. Throws ImportError for
/// indices out of range.
void import_materials(const tinygltf::Model& file, Model& model,
                      std::vector<std::string>& warnings);

/// Index of a named variant (KHR_materials_variants), -1 for an empty name; fills the model's list
/// of names. Throws ImportError for a name the file does not have.
int find_variant(const tinygltf::Model& file, const std::string& name, Model& model);

/// The material of a primitive under a variant (-1: none), as the file says it: -1 is the default
/// material.
int material_of(const tinygltf::Primitive& primitive, int variant);

}  // namespace planecast::render
