#include <memory>

#include "app/commands.h"
#include "app/manual.h"
#include "app/rendering.h"
#include "engine/pipeline/reconstruction_io.h"

namespace planecast::app {
namespace {

struct RenderCommand {
  CommonOptions common;
  InputOptions input;
  RenderingOptions rendering;
  std::string reconstruction;
  std::string output;
  bool causal = false;

  int run() const {
    const Console console = common.console();
    const std::unique_ptr<engine::Sequence> sequence = input.open();
    const engine::Reconstruction map = engine::read_reconstruction(reconstruction);
    engine::ModelShelf models;
    const auto scene = read_scene(rendering, *sequence, models);
    const engine::RenderSequenceResult result = render_with_progress(
        *sequence, map, scene, resolve(rendering, common, input, causal, models), output, console);
    const RenderingReport report = report_rendering(result, output, console);
    common.print_result(
        report.place,
        {{"output", output}, {"interrupted", result.interrupted}, {"rendering", report.figures}});
    if (result.interrupted) throw_interrupted(result, output);
    return result.unreadable.empty() ? kDone : kPoorResult;
  }
};

}  // namespace

void add_render(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("render", "Rendering alone, from a reconstruction");
  auto options = std::make_shared<RenderCommand>();
  add_input_options(*command, options->input);
  command->add_option("--reconstruction", options->reconstruction, "Reconstruction folder")
      ->type_name("DIR")
      ->required();
  command->add_option("-o,--output", options->output, "Folder to write")
      ->type_name("DIR")
      ->required();
  add_json_option(*command, options->common);
  add_rendering_options(*command, options->rendering);
  command->add_flag("--causal", options->causal, "Poses as they were known at their frame");
  add_common_options(*command, options->common);
  set_examples(*command,
               {{"planecast render desk --reconstruction out/map --scene other.yaml -o out/other",
                 "Another scene over a sequence that was tracked before"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
