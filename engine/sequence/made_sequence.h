#pragma once

#include <optional>
#include <string>

#include "engine/scene/yaml_map.h"
#include "engine/sequence/synth.h"

namespace planecast::engine {

/// The synthetic sequence that a YAML file asks for under 'synth': a scene's name, or a mapping of
/// scene, frames, width, height, fps, seed, effects, lens, trouble, of which all but the scene may
/// be left out. Nothing where the key is absent. Throws UserError "file:LINE: reason".
std::optional<SynthOptions> read_synth_options(YamlMap& parent);

/// A name as a folder's: other characters than letters, digits and - _ . become -.
std::string folder_name(const std::string& name);

/// The name of a made sequence's folder tells all that it was made from.
std::string made_sequence_name(const SynthOptions& options);

}  // namespace planecast::engine
