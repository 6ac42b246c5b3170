#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/sequence/synth.h"
#include "engine/user_error.h"

namespace planecast::app {
namespace {

struct SynthCommand {
  CommonOptions common;
  engine::SynthOptions synth;
  std::string output;
  bool list = false;
  bool no_effects = false;

  int run() {
    const Console console = common.console();
    if (list) {
      const std::vector<std::string> names = engine::synthetic_scene_names();
      common.print_result(CLI::detail::join(names, "\n"), names);
      return kDone;
    }
    if (synth.name.empty()) throw engine::UserError("synth: no scene named; --list shows them");
    if (output.empty()) throw engine::UserError("synth: no folder to write; give one with -o");
    synth.seed = common.seed;
    synth.effects = !no_effects;
    {
      ProgressBar bar(console, "making");
      engine::write_synthetic(synth, output,
                              [&bar](int done, int total) { bar.update(done, total); });
    }
    common.print_result(output, {{"output", output}});
    return kDone;
  }
};

}  // namespace

void add_synth(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("synth", "Make a sequence with exact poses, depth and planes");
  auto options = std::make_shared<SynthCommand>();
  command->add_option("name", options->synth.name, "Scene (see --list)")->type_name("SCENE");
  command->add_option("-o,--output", options->output, "Folder to write")->type_name("DIR");
  add_json_option(*command, options->common);
  command->add_flag("--list", options->list, "Print the scenes' names");
  command->add_option("--width", options->synth.width, "Pixels")
      ->type_name("N")
      ->check(CLI::Range(32, 4096))
      ->capture_default_str();
  command->add_option("--height", options->synth.height, "Pixels")
      ->type_name("N")
      ->check(CLI::Range(32, 4096))
      ->capture_default_str();
  command->add_option("--count", options->synth.frames, "Frames (default: the scene's own number)")
      ->type_name("N")
      ->check(CLI::Range(1, 100000));
  command->add_option("--fps", options->synth.fps, "Frames per second")
      ->type_name("N")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  command->add_option("--lens", options->synth.lens, "Distortion of the lens")
      ->type_name("LENS")
      ->check(CLI::IsMember(engine::synthetic_lens_names()))
      ->capture_default_str();
  command
      ->add_option("--trouble", options->synth.trouble,
                   "What makes the recording hard: motion blur, jumps of exposure, a rolling "
                   "shutter, something that moves before the camera, frames that are missing")
      ->type_name("WHAT")
      ->check(CLI::IsMember(engine::synthetic_trouble_names()))
      ->capture_default_str();
  command->add_flag("--no-effects", options->no_effects,
                    "No noise, blur, exposure drift or depth holes");
  add_common_options(*command, options->common);
  set_examples(*command, {{"planecast synth --list", "Names of the scenes"},
                          {"planecast synth tabletop -o tabletop", "A table, 640x480"},
                          {"planecast synth room --width 320 --height 240 --seed 2 -o room",
                           "Smaller, and with other textures and another hand"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
