#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/command_line.h"
#include "app/commands.h"
#include "app/manual.h"
#include "app/rendering.h"
#include "engine/output/atomic_file.h"
#include "engine/output/report.h"
#include "engine/output/summary.h"
#include "engine/pipeline/reconstruction_io.h"
#include "engine/pipeline/resume_tracking.h"
#include "engine/user_error.h"

namespace planecast::app {
namespace {

struct RunCommand {
  CommonOptions common;
  InputOptions input;
  TrackingOptions tracking;
  RenderingOptions rendering;
  std::string output;

  int run() const;

 private:
  engine::Reconstruction reconstruct(engine::Sequence& sequence, const Console& console) const;
  void print_stopped(const engine::Reconstruction& reconstruction) const;
  void write_report(const engine::Reconstruction& reconstruction,
                    const engine::RenderSequenceResult& result,
                    const engine::Sequence& sequence) const;
};

/// Tracks, or, to resume, takes what an earlier run has completed.
engine::Reconstruction RunCommand::reconstruct(engine::Sequence& sequence,
                                               const Console& console) const {
  const engine::TrackSequenceOptions options = tracking.resolve(common, input);
  if (rendering.resume && engine::is_tracked(sequence, options, output)) {
    console.info("resuming with the reconstruction in " + output);
    return engine::read_reconstruction(output);
  }
  const engine::Reconstruction tracked = track_with_progress(sequence, options, console);
  engine::write_tracked(tracked, sequence, options, output);
  // Drawn from the files, as a resumed run does: numbers written as text differ in their last bits.
  engine::Reconstruction reconstruction = engine::read_reconstruction(output);
  reconstruction.stopped = tracked.stopped;
  return reconstruction;
}

/// For those who read the figures of a run that was asked to end.
void RunCommand::print_stopped(const engine::Reconstruction& reconstruction) const {
  common.print_result(output, {{"output", output},
                               {"interrupted", true},
                               {"summary", engine::summary_json(reconstruction)}});
}

void RunCommand::write_report(const engine::Reconstruction& reconstruction,
                              const engine::RenderSequenceResult& result,
                              const engine::Sequence& sequence) const {
  engine::ReportInput report;
  report.title = sequence.name();
  report.command = command_line();
  report.versions = versions(result.renderer);
  report.video = result.video;
  report.fps = sequence.fps();
  report.objects = result.objects;
  report.render_times = result.frame_times;
  for (const auto& [frame, picture] : result.stills) {
    report.stills.push_back({"frame " + std::to_string(frame), picture});
  }
  report.facts.emplace_back("Scene", rendering.scene.empty() ? "built-in" : rendering.scene);
  report.facts.emplace_back("Content in view", std::to_string(result.with_content) + " of " +
                                                   std::to_string(result.frames) + " frames");
  report.facts.emplace_back("Drawn by the processor / by OpenGL",
                            std::to_string(result.by_processor) + " / " +
                                std::to_string(result.with_content - result.by_processor) +
                                " frames");
  report.warnings = result.warnings;
  const std::filesystem::path folder(output);
  for (const char* file : {"augmented.mp4", "scene.glb", "planes.json"}) {
    if (std::filesystem::exists(folder / file)) report.links.emplace_back(file);
  }
  engine::write_report(reconstruction, report, folder / "report.html");
}

int RunCommand::run() const {
  const Console console = common.console();
  const std::unique_ptr<engine::Sequence> sequence = input.open();
  engine::ModelShelf models;
  const auto scene = read_scene(rendering, *sequence, models);
  engine::make_folder(output);
  const engine::Reconstruction reconstruction = reconstruct(*sequence, console);
  const TrackingReport tracked = report_tracking(reconstruction, tracking.causal);
  console.info(tracked.line);
  if (engine::was_interrupted(reconstruction)) {
    print_stopped(reconstruction);
    engine::require_complete(reconstruction);
  }
  const engine::RenderSequenceOptions options =
      resolve(rendering, common, input, tracking.causal, models);
  engine::RenderSequenceResult result;
  try {
    result = render_with_progress(*sequence, reconstruction, scene, options, output, console);
  } catch (const engine::UserError& error) {
    // Where tracking failed the content has no place: that is a poor result, not a bad scene.
    if (!tracked.poor) {
      engine::require_complete(reconstruction);
      throw;
    }
    console.warning(error.what());
    result = render_with_progress(*sequence, reconstruction, engine::SceneFile{}, options, output,
                                  console);
  }
  if (result.interrupted) {
    print_stopped(reconstruction);
    throw_interrupted(result, output);
  }
  write_report(reconstruction, result, *sequence);
  const RenderingReport rendered = report_rendering(result, output, console);
  common.print_result(rendered.place, {{"output", output},
                                       {"poor", tracked.poor},
                                       {"summary", engine::summary_json(reconstruction)},
                                       {"rendering", rendered.figures}});
  if (tracked.poor) console.warning("tracking was lost for more than half of the frames");
  return tracked.poor || !result.unreadable.empty() ? kPoorResult : kDone;
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("run", "Track a sequence and render objects into it: the main job");
  auto options = std::make_shared<RunCommand>();
  options->output = "out/run";
  add_input_options(*command, options->input);
  command->add_option("-o,--output", options->output, "Folder to write")
      ->type_name("DIR")
      ->capture_default_str();
  add_json_option(*command, options->common);
  add_rendering_options(*command, options->rendering);
  add_tracking_options(*command, options->tracking);
  add_common_options(*command, options->common);
  set_examples(
      *command,
      {{"planecast run walk.mp4 -o out/walk",
        "Track a video and put the built-in model where the camera looks"},
       {"planecast run desk --scene scene.yaml --camera phone.yaml -o out/desk",
        "The objects of a scene file, seen by a calibrated camera"},
       {"planecast run desk --frames 0:200 --size 320x240 --png --no-video -o out/try",
        "A quick try: the first 200 frames at half the size, as pictures"},
       {"planecast run desk --scene scene.yaml -o out/desk --resume", "Go on after a killed run"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
