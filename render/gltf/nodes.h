#pragma once

#include "render/gltf/model.h"
#include "render/gltf/tinygltf_fwd.h"

namespace planecast::render {

/// Nodes, the order of a scene (-1: the default one), skins and animations; meshes and materials
/// must be there. A node with EXT_mesh_gpu_instancing gets a child for each instance. Throws
/// ImportError for cycles, second parents and indices out of range.
void import_nodes(const tinygltf::Model& file, int scene, Model& model);
void import_skins(const tinygltf::Model& file, Model& model);
void import_animations(const tinygltf::Model& file, Model& model);
void import_cameras_and_lights(const tinygltf::Model& file, Model& model);

}  // namespace planecast::render
