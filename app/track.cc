#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "engine/output/atomic_file.h"
#include "engine/pipeline/reconstruction_io.h"

namespace planecast::app {
namespace {

struct TrackCommand {
  CommonOptions common;
  InputOptions input;
  TrackingOptions tracking;
  std::string output;
  std::string map;

  int run() const {
    const Console console = common.console();
    engine::TrackSequenceOptions options = tracking.resolve(common, input);
    options.map = map;
    const std::unique_ptr<engine::Sequence> sequence = input.open();
    engine::make_folder(output);
    const engine::Reconstruction reconstruction = track_with_progress(*sequence, options, console);
    engine::write_reconstruction(reconstruction, output);
    const TrackingReport report = report_tracking(reconstruction, tracking.causal);
    console.info(report.line);
    console.result(output);
    if (report.poor) console.warning("tracking was lost for more than half of the frames");
    return report.poor ? kPoorResult : kDone;
  }
};

}  // namespace

void add_track(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("track", "SLAM alone: camera path, planes and points");
  auto options = std::make_shared<TrackCommand>();
  add_input_options(*command, options->input);
  command->add_option("-o,--output", options->output, "Reconstruction folder to write")->required();
  command->add_option("--map", options->map,
                      "Earlier reconstruction of the place to localise in and go on from");
  add_tracking_options(*command, options->tracking);
  add_common_options(*command, options->common);
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
