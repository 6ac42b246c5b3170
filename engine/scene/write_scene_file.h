#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/scene_file.h"

namespace planecast::engine {

/// A scene as YAML that read_scene_file() takes: everything that it holds, nothing that is the
/// default. Models are named relative to `folder`, where the file is to lie.
std::string scene_yaml(const SceneFile& scene, const std::filesystem::path& folder);

/// Throws UserError where the file cannot be written.
void write_scene_file(const SceneFile& scene, const std::filesystem::path& path);

}  // namespace planecast::engine
