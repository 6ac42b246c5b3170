#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

namespace planecast::app {

inline constexpr const char* kVersion = PLANECAST_VERSION;

/// What the parsed command line asks for; returns the exit status.
using Action = std::function<int()>;

/// The whole command line. What was parsed sets `action`, which must outlive it.
std::unique_ptr<CLI::App> make_cli(Action& action);

/// Each adds one subcommand, which sets `action` when it is chosen.
void add_run(CLI::App& app, Action& action);
void add_track(CLI::App& app, Action& action);
void add_render(CLI::App& app, Action& action);
void add_synth(CLI::App& app, Action& action);
void add_segment(CLI::App& app, Action& action);
void add_evaluate(CLI::App& app, Action& action);
void add_benchmark(CLI::App& app, Action& action);
void add_inspect(CLI::App& app, Action& action);
void add_model(CLI::App& app, Action& action);
void add_golden(CLI::App& app, Action& action);
void add_calibrate(CLI::App& app, Action& action);
void add_completion(CLI::App& app, Action& action);

}  // namespace planecast::app
