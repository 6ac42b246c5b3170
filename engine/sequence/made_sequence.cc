#include "engine/sequence/made_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace planecast::engine {
namespace {

constexpr const char* kKey = "synth";

std::string known_scene(YamlMap& map, const std::string& key) {
  const auto scene = map.text(key);
  if (!scene) map.fail(key, "'synth' needs a scene");
  const std::vector<std::string> known = synthetic_scene_names();
  if (std::find(known.begin(), known.end(), *scene) == known.end()) {
    map.fail(key, *scene + ": no such synthetic scene");
  }
  return *scene;
}

}  // namespace

std::optional<SynthOptions> read_synth_options(YamlMap& parent) {
  SynthOptions options;
  const YAML::Node node = parent.node(kKey);
  if (!node) return std::nullopt;
  if (node.IsScalar()) {
    options.name = known_scene(parent, kKey);
    return options;
  }
  YamlMap map = *parent.map(kKey);
  options.name = known_scene(map, "scene");
  options.frames = map.integer("frames").value_or(options.frames);
  options.width = map.integer("width").value_or(options.width);
  options.height = map.integer("height").value_or(options.height);
  options.fps = map.number("fps").value_or(options.fps);
  options.seed = static_cast<std::uint64_t>(map.integer("seed").value_or(1));
  options.effects = map.boolean("effects").value_or(options.effects);
  if (const auto lens = map.choice("lens", synthetic_lens_names())) options.lens = *lens;
  if (const auto trouble = map.choice("trouble", synthetic_trouble_names())) {
    options.trouble = *trouble;
  }
  if (map.has("frames") && options.frames < 1) map.fail("frames", "'frames' must be positive");
  map.finish();
  return options;
}

std::string folder_name(const std::string& name) {
  std::string clean = name;
  std::replace_if(
      clean.begin(), clean.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_' && c != '.'; },
      '-');
  return clean;
}

std::string made_sequence_name(const SynthOptions& synth) {
  return folder_name(
      fmt::format("{}-{}x{}-{}fps-{}-seed{}{}{}{}", synth.name, synth.width, synth.height,
                  synth.fps, synth.frames > 0 ? std::to_string(synth.frames) : "all", synth.seed,
                  synth.lens == "none" ? "" : "-" + synth.lens, synth.effects ? "" : "-clean",
                  synth.trouble == "none" ? "" : "-" + synth.trouble));
}

}  // namespace planecast::engine
