#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include "app/commands.h"
#include "app/console.h"
#include "app/options.h"
#include "app/signals.h"
#include "engine/cancel.h"
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
  } catch (const engine::Cancelled& end) {
    const int signal = app::stopping_signal();
    std::fprintf(stderr, "planecast: interrupted by %s: %s\n", app::signal_name(signal).c_str(),
                 one_line(end.what()).c_str());
    return app::exit_status_of(signal);
  } catch (const engine::UserError& error) {
    std::fprintf(stderr, "planecast: %s\n", one_line(error.what()).c_str());
    return app::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "planecast: internal error: %s\n", one_line(error.what()).c_str());
    return app::kInternalError;
  }
}

}  // namespace

int main(int argc, char** argv) {
  app::silence_libraries();
  app::Action action;
  const std::unique_ptr<CLI::App> whole = app::make_cli(action);
  CLI::App& cli = *whole;
  try {
    cli.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return cli.exit(help);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "planecast: %s (see planecast --help)\n",
                 one_line(describe(error, cli, argc, argv)).c_str());
    return app::kBadInput;
  }
  app::stop_on_signals();
  return run_action(action);
}
