#pragma once

#include <optional>
#include <string>

#include "engine/scene/scene_file.h"
#include "engine/scene/yaml_map.h"

namespace planecast::engine {

/// Reads the key `scale` of a scene. Throws UserError.
std::optional<ScaleHint> read_scale(YamlMap& root, const std::string& file);

}  // namespace planecast::engine
