#include <cstdio>
#include <memory>
#include <string>

#include "app/commands.h"
#include "app/man_page.h"
#include "app/manual.h"

namespace planecast::app {
namespace {

constexpr const char* kPurpose =
    "Works out where the camera of a recorded image sequence went and which planes its scene is "
    "made of, puts glTF objects on those planes and writes an augmented video.";
constexpr const char* kNotes =
    "Exit status: 0 done; 1 done, but the result is poor (tracking lost for more than half of the\n"
    "frames, a golden picture differs); 2 bad input or usage, one line on stderr says which file\n"
    "and why; 3 internal error; 130 and 143 interrupted by SIGINT or SIGTERM: what was done is\n"
    "written, and a second signal ends the program at once.\n"
    "Environment: PLANECAST_ASSETS is the folder of models, shaders and weights, where it is not\n"
    "found beside the executable.\n"
    "`planecast COMMAND --help` documents each command and gives examples.";

void add_commands(CLI::App& cli, Action& action) {
  add_run(cli, action);
  add_track(cli, action);
  add_render(cli, action);
  add_segment(cli, action);
  add_calibrate(cli, action);
  add_synth(cli, action);
  add_model(cli, action);
  add_evaluate(cli, action);
  add_benchmark(cli, action);
  add_inspect(cli, action);
  add_golden(cli, action);
  add_completion(cli, action);
}

/// Prints the man page, for the build.
void add_man_flag(CLI::App& cli) {
  cli.add_flag_callback("--help-man",
                        [&cli] {
                          std::fputs(man_page(cli, kVersion).c_str(), stdout);
                          throw CLI::Success();
                        })
      ->group("");
}

}  // namespace

std::unique_ptr<CLI::App> make_cli(Action& action) {
  auto cli = std::make_unique<CLI::App>(kPurpose, "planecast");
  use_plain_help(*cli);
  cli->footer(kNotes);
  cli->require_subcommand(1);
  cli->set_version_flag("--version", std::string("planecast ") + kVersion);
  add_man_flag(*cli);
  add_commands(*cli, action);
  return cli;
}

}  // namespace planecast::app
