#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/commands.h"
#include "engine/benchmark/config.h"
#include "engine/golden/suite.h"
#include "engine/scene/scene_file.h"
#include "engine/sequence/frame_options.h"
#include "test/fuzz/memory_file.h"
#include "test/fuzz/target.h"

namespace planecast::fuzz {

/// Scenes, and what else is written by hand in YAML.
void read_scene(std::string_view bytes) {
  const std::string& folder = memory_folder();
  put_file(folder + "/m.glb", "");
  put_file(folder + "/scene.yaml", bytes);
  put_file(folder + "/golden.yaml", bytes);
  answer([&] { engine::read_scene_file(folder + "/scene.yaml"); });
  answer([&] { engine::read_golden_suite(folder); });
  answer([&] { engine::read_benchmark_config(folder + "/scene.yaml"); });
}

/// Words end with a line's end. What was parsed is not run.
void read_command_line(std::string_view bytes) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
    words.emplace_back(bytes.substr(begin, end - begin));
    begin = end + 1;
  }
  for (const std::string& word : words) {
    engine::SequenceOptions options;
    answer([&] { engine::parse_frames(word, options); });
    answer([&] { engine::parse_size(word); });
  }
  app::Action action;
  const std::unique_ptr<CLI::App> cli = app::make_cli(action);
  // CLI11 takes them from the end.
  std::reverse(words.begin(), words.end());
  try {
    cli->parse(words);
  } catch (const CLI::Error&) {
  }
}

}  // namespace planecast::fuzz
