#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "app/commands.h"
#include "app/console.h"
#include "app/man_page.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/user_error.h"

namespace {

using namespace planecast;

/// Messages are one line each, whatever made them.
std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

/// CLI11 would only say that a command is missing.
std::string describe(const CLI::ParseError& error, const CLI::App& cli, int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  const auto commands =
      cli.get_subcommands([&](const CLI::App* command) { return command->get_name() == first; });
  if (!first.empty() && first[0] != '-' && commands.empty()) {
    return "unknown command '" + first + "'";
  }
  return error.what();
}

int run_action(const app::Action& action) {
  try {
    return action();
  } catch (const engine::UserError& error) {
    std::fprintf(stderr, "planecast: %s\n", one_line(error.what()).c_str());
    return app::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "planecast: internal error: %s\n", one_line(error.what()).c_str());
    return app::kInternalError;
  }
}

constexpr const char* kPurpose =
    "Works out where the camera of a recorded image sequence went and which planes its scene is "
    "made of, puts glTF objects on those planes and writes an augmented video.";
constexpr const char* kNotes =
    "Exit status: 0 done; 1 done, but the result is poor (tracking lost for more than half of the\n"
    "frames, a golden picture differs); 2 bad input or usage, one line on stderr says which file\n"
    "and why; 3 internal error.\n"
    "Environment: PLANECAST_ASSETS is the folder of models, shaders and weights, where it is not\n"
    "found beside the executable.\n"
    "`planecast COMMAND --help` documents each command and gives examples.";

void add_commands(CLI::App& cli, app::Action& action) {
  app::add_run(cli, action);
  app::add_track(cli, action);
  app::add_render(cli, action);
  app::add_segment(cli, action);
  app::add_calibrate(cli, action);
  app::add_synth(cli, action);
  app::add_model(cli, action);
  app::add_evaluate(cli, action);
  app::add_benchmark(cli, action);
  app::add_inspect(cli, action);
  app::add_golden(cli, action);
  app::add_completion(cli, action);
}

/// Prints the man page, for the build.
void add_man_flag(CLI::App& cli) {
  cli.add_flag_callback("--help-man",
                        [&cli] {
                          std::fputs(app::man_page(cli, app::kVersion).c_str(), stdout);
                          throw CLI::Success();
                        })
      ->group("");
}

}  // namespace

int main(int argc, char** argv) {
  app::silence_libraries();
  CLI::App cli(kPurpose, "planecast");
  app::use_plain_help(cli);
  cli.footer(kNotes);
  cli.require_subcommand(1);
  cli.set_version_flag("--version", std::string("planecast ") + app::kVersion);
  add_man_flag(cli);
  app::Action action;
  add_commands(cli, action);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return cli.exit(help);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "planecast: %s (see planecast --help)\n",
                 one_line(describe(error, cli, argc, argv)).c_str());
    return app::kBadInput;
  }
  return run_action(action);
}
