#pragma once

#include "render/gltf/model.h"
#include "render/gltf/tinygltf_fwd.h"

namespace planecast::render {

/// Nodes, the default scene's order, skins and animations; meshes and materials must be there.
/// Throws ImportError for cycles, second parents and indices out of range.
void import_nodes(const tinygltf::Model& file, Model& model);
void import_skins(const tinygltf::Model& file, Model& model);
void import_animations(const tinygltf::Model& file, Model& model);

}  // namespace planecast::render
