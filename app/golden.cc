#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/golden/check.h"
#include "engine/golden/report.h"
#include "engine/output/atomic_file.h"

namespace planecast::app {
namespace {

struct GoldenCommand {
  CommonOptions common;
  std::string folder;
  std::string output;
  std::string junit;
  std::vector<std::string> only;

  int init() const;
  int check() const;
  int update() const;

 private:
  engine::GoldenOptions options() const;
  static engine::GoldenWatch watch(const Console& console);
  int exit_status(const std::vector<engine::GoldenResult>& results) const;
};

engine::GoldenOptions GoldenCommand::options() const {
  engine::GoldenOptions result;
  result.output = output;
  if (output.empty()) result.output = std::filesystem::path(folder) / "out";
  result.only = only;
  result.threads = common.threads;
  return result;
}

/// A bar for each case.
engine::GoldenWatch GoldenCommand::watch(const Console& console) {
  return [&console](const std::string& name) {
    const auto bar = std::make_shared<ProgressBar>(console, name);
    return [bar](int done, int total) { bar->update(done, total); };
  };
}

int GoldenCommand::exit_status(const std::vector<engine::GoldenResult>& results) const {
  const auto any = [&results](engine::GoldenStatus status) {
    return std::ranges::any_of(
        results, [status](const engine::GoldenResult& result) { return result.status == status; });
  };
  if (any(engine::GoldenStatus::kFailed) || any(engine::GoldenStatus::kMissing)) return kBadInput;
  return any(engine::GoldenStatus::kDiffers) ? kPoorResult : kDone;
}

int GoldenCommand::init() const {
  engine::init_golden_suite(folder);
  common.console().result((std::filesystem::path(folder) / "golden.yaml").string());
  return kDone;
}

int GoldenCommand::check() const {
  const Console console = common.console();
  const engine::GoldenSuite suite = engine::read_golden_suite(folder);
  const engine::GoldenOptions wanted = options();
  const auto results = engine::check_golden_suite(suite, wanted, watch(console));
  int same = 0;
  for (const engine::GoldenResult& result : results) {
    if (result.status == engine::GoldenStatus::kSame) {
      ++same;
      console.detail(result.title() + ": " + result.message);
    } else {
      console.error(result.title() + ": " + result.message);
    }
  }
  const std::filesystem::path report = wanted.output / "report.html";
  engine::write_golden_report(results, "Golden pictures of " + folder, report);
  if (!junit.empty()) engine::write_junit(results, junit);
  console.info(std::to_string(same) + " of " + std::to_string(results.size()) +
               " pictures as expected");
  common.print_result(
      report.string(),
      {{"report", report.string()}, {"same", same}, {"pictures", engine::to_json(results)}});
  return exit_status(results);
}

int GoldenCommand::update() const {
  const Console console = common.console();
  const engine::GoldenSuite suite = engine::read_golden_suite(folder);
  const int pictures = engine::update_golden_suite(suite, options(), watch(console));
  console.info(std::to_string(pictures) + " pictures are expected from now on");
  console.result(suite.expected_folder().string());
  return kDone;
}

CLI::App* add_action(CLI::App& golden, const char* name, const char* what,
                     const std::shared_ptr<GoldenCommand>& options,
                     int (GoldenCommand::*run)() const, Action& action) {
  CLI::App* command = golden.add_subcommand(name, what);
  command->add_option("dir", options->folder, "Folder of golden.yaml and expected/")
      ->required()
      ->type_name("DIR");
  command->callback(
      [options, run, &action] { action = [options, run] { return (*options.*run)(); }; });
  return command;
}

void add_drawing_options(CLI::App& command, GoldenCommand& options) {
  command
      .add_option("-o,--output", options.output,
                  "Folder for the report, the pictures drawn and made sequences (default: DIR/out)")
      ->type_name("DIR");
  command.add_option("--only", options.only, "Names of the cases to draw")->type_name("CASE");
}

}  // namespace

void add_golden(CLI::App& app, Action& action) {
  CLI::App* golden = app.add_subcommand("golden", "Compare pictures with expected ones, as in CI");
  golden->require_subcommand(1);
  auto options = std::make_shared<GoldenCommand>();

  CLI::App* init = add_action(*golden, "init", "Write a golden.yaml to begin with", options,
                              &GoldenCommand::init, action);
  add_console_options(*init, options->common);
  set_examples(*init, {{"planecast golden init tests/pictures",
                        "Then change its golden.yaml and take the first pictures by `update`"}});

  CLI::App* check = add_action(*golden, "check", "Draw every case and compare; 1 where one differs",
                               options, &GoldenCommand::check, action);
  add_drawing_options(*check, *options);
  check->add_option("--junit", options->junit, "Write JUnit's XML for a CI system too")
      ->type_name("FILE");
  add_json_option(*check, options->common);
  add_console_options(*check, options->common);
  add_threads_option(*check, options->common);
  set_examples(*check,
               {{"planecast golden check tests/pictures --junit out/golden.xml",
                 "What a CI job runs; out/report.html below the folder shows the differences"},
                {"planecast golden check tests/pictures --only table", "One case alone"}});

  CLI::App* update = add_action(*golden, "update", "Draw every case and take it for expected",
                                options, &GoldenCommand::update, action);
  add_drawing_options(*update, *options);
  add_console_options(*update, options->common);
  add_threads_option(*update, options->common);
  set_examples(*update, {{"planecast golden update tests/pictures",
                          "Look at the pictures in expected/ before you commit them"}});
}

}  // namespace planecast::app
