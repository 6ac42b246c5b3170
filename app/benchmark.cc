#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/benchmark/config.h"
#include "engine/benchmark/report_files.h"
#include "engine/benchmark/runner.h"
#include "engine/cancel.h"
#include "engine/output/atomic_file.h"

namespace planecast::app {
namespace {

nlohmann::ordered_json to_json(const std::vector<engine::BenchmarkRow>& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const engine::BenchmarkRow& row : rows) {
    json.push_back({{"sequence", row.run.sequence->name},
                    {"mode", row.run.mode},
                    {"variant", row.run.variant->name},
                    {"seed", row.run.seed},
                    {"status", row.status},
                    {"metrics", row.metrics}});
  }
  return json;
}

struct BenchmarkCommand {
  CommonOptions common;
  std::string config;
  int seeds = 0;  ///< 0: as the configuration says
  engine::BenchmarkOptions options;

  int run() {
    const Console console = common.console();
    const engine::BenchmarkConfig plan = engine::read_benchmark_config(config);
    for (int seed = 1; seed <= seeds; ++seed) {
      options.seeds.push_back(static_cast<std::uint64_t>(seed));
    }
    engine::make_folder(options.output);
    engine::BenchmarkRunner runner(
        plan, options, [&console](int done, int total, const std::string& line) {
          console.info("[" + std::to_string(done) + "/" + std::to_string(total) + "] " + line);
        });
    const std::vector<engine::BenchmarkRow> rows = runner.run();
    engine::write_benchmark_report(plan, rows, runner, facts(plan), options.output);
    const std::string results = (options.output / "results.md").string();
    common.print_result(results, {{"results", results},
                                  {"interrupted", engine::cancel_requested()},
                                  {"rows", to_json(rows)}});
    engine::throw_if_cancelled("runs that were completed are in the results; --resume keeps them");
    const bool failed = std::any_of(rows.begin(), rows.end(), [](const engine::BenchmarkRow& row) {
      return !row.usable() && row.status != "not present";
    });
    return failed ? kPoorResult : kDone;
  }

 private:
  std::vector<std::string> facts(const engine::BenchmarkConfig& plan) const {
    const std::size_t count = options.seeds.empty() ? plan.seeds.size() : options.seeds.size();
    std::vector<std::string> lines = {
        std::string("planecast ") + kVersion + " on " + engine::processor_name(),
        count == 1 ? std::string("one seed; a cell is its figure")
                   : std::to_string(count) + " seeds; a cell is the median (mean, worst)"};
    if (!plan.options.empty())
      lines.push_back("`track` with " + CLI::detail::join(plan.options, " "));
    return lines;
  }
};

}  // namespace

void add_benchmark(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("benchmark", "Track many sequences and print tables of the figures");
  auto options = std::make_shared<BenchmarkCommand>();
  command->add_option("config", options->config, "Configuration, YAML (see assets/benchmark)")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("-o,--output", options->options.output,
                   "Folder for runs, results.md, results.csv and plots")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--cache", options->options.cache,
                   "Folder of made sequences (default: below the output)")
      ->type_name("DIR");
  command->add_option("--only", options->options.only, "Names of the sequences to run")
      ->type_name("NAME");
  command->add_option("--seeds", options->seeds, "Seeds 1 to N instead of the configuration's")
      ->type_name("N")
      ->check(CLI::Range(1, 100));
  command->add_flag("--resume", options->options.resume,
                    "Keep the runs that are complete with the same arguments");
  add_json_option(*command, options->common);
  add_console_options(*command, options->common);
  set_examples(*command,
               {{"planecast benchmark assets/benchmark/builtin.yaml -o out/bench --seeds 1",
                 "Every built-in sequence once"},
                {"planecast benchmark mine.yaml -o out/bench --only desk --resume",
                 "One sequence of a configuration; runs that are complete are kept"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
