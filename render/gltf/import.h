#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "render/scene.h"

namespace planecast::render {

struct ImportResult {
  std::shared_ptr<const Model> model;  ///< null on failure
  std::string error;                   ///< one line, without the file's name
  std::vector<std::string> warnings;
};

struct ImportOptions {
  int scene = -1;       ///< index; -1: the file's default, or the first
  std::string variant;  ///< of KHR_materials_variants; empty: the materials of the primitives
};

/// Reads a .gltf or .glb file with the files it names beside it. Never throws for a bad file, never
/// crashes.
ImportResult import_gltf(const std::string& path, const ImportOptions& options = {});

struct Bounds {
  glm::vec3 min{};
  glm::vec3 max{};
};
/// Of the default scene in its rest pose (or with an animation at a time), model space.
Bounds model_bounds(const Model& model);
/// Names by index; unnamed ones are "".
std::vector<std::string> animation_names(const Model& model);
/// What the file contains and uses, one line each: scenes, cameras, lights, variants, animations,
/// materials, triangles.
std::vector<std::string> describe_model(const Model& model);
float animation_duration_s(const Model& model, int animation);

}  // namespace planecast::render
