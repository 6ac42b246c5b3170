#include <memory>

#include "app/commands.h"
#include "app/rendering.h"
#include "engine/pipeline/reconstruction_io.h"
#include "engine/user_error.h"

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
    const slam::Camera& camera = sequence->camera();
    if (camera.width != map.camera.width || camera.height != map.camera.height) {
      throw engine::UserError(input.sequence + ": frames of " + std::to_string(camera.width) + "x" +
                              std::to_string(camera.height) + " do not fit the reconstruction's " +
                              std::to_string(map.camera.width) + "x" +
                              std::to_string(map.camera.height));
    }
    const auto scene = read_scene(rendering, *sequence);
    const engine::RenderSequenceResult result = render_with_progress(
        *sequence, map, scene, resolve(rendering, common, input, causal), output, console);
    report_rendering(result, output, console);
    return result.unreadable.empty() ? kDone : kPoorResult;
  }
};

}  // namespace

void add_render(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("render", "Rendering alone, from a reconstruction");
  auto options = std::make_shared<RenderCommand>();
  add_input_options(*command, options->input);
  command->add_option("--reconstruction", options->reconstruction, "Reconstruction folder")
      ->required();
  command->add_option("-o,--output", options->output, "Folder to write")->required();
  add_rendering_options(*command, options->rendering);
  command->add_flag("--causal", options->causal, "Poses as they were known at their frame");
  add_common_options(*command, options->common);
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
