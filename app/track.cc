#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/output/atomic_file.h"
#include "engine/output/summary.h"
#include "engine/pipeline/resume_tracking.h"

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
    engine::write_tracked(reconstruction, *sequence, options, output);
    const TrackingReport report = report_tracking(reconstruction, tracking.causal);
    console.info(report.line);
    common.print_result(output, {{"output", output},
                                 {"poor", report.poor},
                                 {"interrupted", engine::was_interrupted(reconstruction)},
                                 {"summary", engine::summary_json(reconstruction)}});
    engine::require_complete(reconstruction);
    if (report.poor) console.warning("tracking was lost for more than half of the frames");
    return report.poor ? kPoorResult : kDone;
  }
};

}  // namespace

void add_track(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("track", "SLAM alone: camera path, planes and points");
  auto options = std::make_shared<TrackCommand>();
  add_input_options(*command, options->input);
  command->add_option("-o,--output", options->output, "Reconstruction folder to write")
      ->type_name("DIR")
      ->required();
  add_json_option(*command, options->common);
  command
      ->add_option("--map", options->map,
                   "Earlier reconstruction of the place to localise in and go on from")
      ->type_name("DIR");
  add_tracking_options(*command, options->tracking);
  add_common_options(*command, options->common);
  set_examples(*command,
               {{"planecast track desk -o out/map", "Camera path, planes and points of a sequence"},
                {"planecast track desk --mode mono --segmentation none -o out/map",
                 "Without the depth and the masks that it has"},
                {"planecast track again.mp4 --map out/map -o out/again",
                 "Another recording of the same place, in the first one's world"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
