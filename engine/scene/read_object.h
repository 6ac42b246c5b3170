#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/scene/scene_file.h"
#include "engine/scene/yaml_map.h"

namespace planecast::engine {

/// Reads one entry of `objects`: one object, or one for each of its `instances`. Throws UserError.
std::vector<SceneObject> read_object(const YAML::Node& node, const std::string& file,
                                     const std::filesystem::path& path);

/// `dictionary` and `id` of a marker.
MarkerId read_marker(YamlMap& map);

}  // namespace planecast::engine
