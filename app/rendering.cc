#include "app/rendering.h"

#include <cstdio>

#include "app/manual.h"
#include "engine/cancel.h"
#include "engine/scene/content.h"
#include "engine/scene/default_scene.h"

namespace planecast::app {

void add_rendering_options(CLI::App& command, RenderingOptions& options) {
  const OptionGroup group(command, "Rendering");
  command
      .add_option("--scene", options.scene,
                  "Scene file (default: a built-in model where the camera looks)")
      ->type_name("FILE");
  command.add_flag("--png", options.png, "Write each frame as PNG too");
  command.add_flag("--no-video", options.no_video, "Write no video");
  command.add_flag("--debug-overlay", options.debug_overlay, "Draw plane outlines over the frames");
  command
      .add_option("--painter", options.painter,
                  "auto draws simple objects without OpenGL, which is faster; gl never does")
      ->type_name("auto|gl")
      ->check(CLI::IsMember({"auto", "gl"}))
      ->capture_default_str();
  command.add_flag("--resume", options.resume, "Go on where a killed run stopped");
}

std::optional<engine::SceneFile> read_scene(const RenderingOptions& options,
                                            const engine::Sequence& sequence,
                                            engine::ModelShelf& models) {
  if (options.scene.empty()) return std::nullopt;
  engine::SceneFile scene = engine::read_scene_file(options.scene);
  engine::check_content(scene, sequence.first_frame(), sequence.end_frame(), models);
  return scene;
}

engine::RenderSequenceOptions resolve(const RenderingOptions& rendering,
                                      const CommonOptions& common, const InputOptions& input,
                                      bool causal, engine::ModelShelf& models) {
  engine::RenderSequenceOptions options;
  options.causal = causal;
  options.video = !rendering.no_video;
  options.png = rendering.png;
  options.debug_overlay = rendering.debug_overlay;
  options.resume = rendering.resume;
  options.skip_unreadable = input.skip_unreadable;
  options.only_opengl = rendering.painter == "gl";
  options.threads = common.threads;
  options.seed = common.seed;
  options.models = &models;
  return options;
}

engine::RenderSequenceResult render_with_progress(engine::Sequence& sequence,
                                                  const engine::Reconstruction& reconstruction,
                                                  const std::optional<engine::SceneFile>& scene,
                                                  const engine::RenderSequenceOptions& options,
                                                  const std::filesystem::path& folder,
                                                  const Console& console) {
  const engine::SceneFile chosen =
      scene ? *scene : engine::default_scene(reconstruction, engine::builtin_models());
  ProgressBar bar(console, "rendering");
  return engine::render_sequence(sequence, reconstruction, chosen, options, folder,
                                 [&bar](int done, int total) { bar.update(done, total); });
}

RenderingReport report_rendering(const engine::RenderSequenceResult& result,
                                 const std::filesystem::path& folder, const Console& console) {
  for (const std::string& warning : result.warnings) console.warning(warning);
  for (const int frame : result.unreadable) {
    console.warning("frame " + std::to_string(frame) +
                    " could not be read; the picture before it is repeated");
  }
  if (result.units_per_metre > 0.0) {
    console.detail("scale: " + std::to_string(result.units_per_metre) + " map units a metre");
  }
  for (const auto& [step, ms] : result.mean_ms) {
    char text[64];
    std::snprintf(text, sizeof(text), "%-10s %6.1f ms a frame", step.c_str(), ms);
    console.detail(text);
  }
  console.info("content is in view in " + std::to_string(result.with_content) + " of " +
               std::to_string(result.frames) + " frames");
  console.detail("drawn by the processor: " + std::to_string(result.by_processor) +
                 ", by OpenGL: " + std::to_string(result.with_content - result.by_processor));
  RenderingReport report;
  report.place =
      result.video.empty() || result.interrupted ? folder.string() : result.video.string();
  report.figures["frames"] = result.frames;
  report.figures["with_content"] = result.with_content;
  report.figures["drawn_by"] = {{"processor", result.by_processor},
                                {"opengl", result.with_content - result.by_processor}};
  report.figures["unreadable"] = result.unreadable;
  report.figures["mean_ms"] = result.mean_ms;
  report.figures["warnings"] = result.warnings;
  if (!result.video.empty() && !result.interrupted) report.figures["video"] = result.video.string();
  return report;
}

void throw_interrupted(const engine::RenderSequenceResult& result,
                       const std::filesystem::path& folder) {
  std::string how_far = std::to_string(result.frames) + " frames were drawn";
  if (!result.video.empty()) {
    how_far += "; complete parts of the video are in " + (folder / "segments").string() +
               ", and --resume goes on from there";
  }
  throw engine::Cancelled(how_far);
}

}  // namespace planecast::app
