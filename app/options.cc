#include "app/options.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/manual.h"
#include "engine/output/atomic_file.h"
#include "engine/output/json_text.h"
#include "engine/segmentation/choose_segmenter.h"
#include "engine/sequence/frame_options.h"
#include "engine/user_error.h"

namespace planecast::app {
namespace {

Eigen::Vector3d parse_direction(const std::string& text) {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  char rest = 0;
  const int count = std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &v.x(), &v.y(), &v.z(), &rest);
  if (count != 3 || !v.allFinite() || v.norm() < 1e-9) {
    throw engine::UserError("--up " + text + ": expected a direction as x,y,z");
  }
  return v.normalized();
}

}  // namespace

Console CommonOptions::console() const {
  const Verbosity verbosity = quiet     ? Verbosity::kQuiet
                              : verbose ? Verbosity::kVerbose
                                        : Verbosity::kNormal;
  return Console(verbosity, !no_progress);
}

void CommonOptions::print_result(const std::string& text,
                                 const nlohmann::ordered_json& figures) const {
  const std::string machine = json.empty() ? "" : engine::json_text(figures, 2);
  if (json == "-") {
    console().result(machine);
    return;
  }
  console().result(text);
  if (!json.empty()) engine::write_file(json, machine + "\n");
}

void add_json_option(CLI::App& command, CommonOptions& options) {
  command
      .add_option("--json", options.json,
                  "Write the figures to this file too, or with - print them instead of the text")
      ->type_name("FILE");
}

void add_console_options(CLI::App& command, CommonOptions& options) {
  const OptionGroup group(command, "Common options");
  CLI::Option* quiet = command.add_flag("--quiet", options.quiet, "Print results and errors alone");
  command.add_flag("--verbose", options.verbose, "Print what is being done")->excludes(quiet);
  command.add_flag("--no-progress", options.no_progress, "No progress bar");
}

void add_threads_option(CLI::App& command, CommonOptions& options) {
  const OptionGroup group(command, "Common options");
  command.add_option("--threads", options.threads, "Threads to use; changes no result")
      ->type_name("N")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

void add_common_options(CLI::App& command, CommonOptions& options) {
  add_console_options(command, options);
  add_threads_option(command, options);
  const OptionGroup group(command, "Common options");
  command.add_option("--seed", options.seed, "Seed of everything random")
      ->type_name("N")
      ->capture_default_str();
}

void add_input_options(CLI::App& command, InputOptions& options) {
  const OptionGroup group(command, "Input");
  command.add_option("sequence", options.sequence, "Sequence folder, image folder or video file")
      ->required()
      ->type_name("SEQUENCE");
  command
      .add_option("--camera", options.camera,
                  "Camera preset or file (default: camera.yaml of the sequence, else a guess)")
      ->type_name("PRESET|FILE");
  command.add_option("--frames", options.frames, "Frames A to B, counted from 0, B excluded")
      ->type_name("A:B");
  command.add_option("--size", options.size, "Resize the frames")->type_name("WxH");
  command.add_flag("--skip-unreadable", options.skip_unreadable,
                   "Go on after a frame that cannot be read");
}

std::unique_ptr<engine::Sequence> InputOptions::open() const {
  engine::SequenceOptions result;
  result.camera = camera;
  if (!frames.empty()) engine::parse_frames(frames, result);
  if (!size.empty()) result.size = engine::parse_size(size);
  return engine::open_sequence(sequence, result);
}

void add_segmentation_options(CLI::App& command, std::string& segmentation, std::string& network) {
  command.add_option("--segmentation", segmentation, "Where plane masks come from")
      ->type_name("HOW")
      ->check(CLI::IsMember(engine::segmentation_kinds()))
      ->capture_default_str();
  command.add_option("--network", network,
                     "ONNX file for the masks, its description beside it (default: our own)");
}

void add_tracking_options(CLI::App& command, TrackingOptions& options) {
  const OptionGroup group(command, "Tracking and mapping");
  command
      .add_option("--mode", options.mode,
                  "Camera alone, with depth, or with depth where there is some")
      ->type_name("MODE")
      ->check(CLI::IsMember({"mono", "rgbd", "auto"}))
      ->capture_default_str();
  add_segmentation_options(command, options.segmentation, options.network);
  command
      .add_option("--mask-leakage", options.mask_leakage,
                  "Corrupt the masks: this share of each is taken from what adjoins")
      ->check(CLI::Range(0.0, 0.9))
      ->capture_default_str();
  command.add_flag("--causal", options.causal,
                   "Each frame as it was known at its time (default: two passes)");
  command.add_flag("--no-loop-closing", options.no_loop_closing,
                   "Do not correct the drift where the camera comes back to a known place");
  command.add_option("--up", options.up, "World's up direction (first camera: x right, y down)")
      ->type_name("X,Y,Z");
  command
      .add_option("--plane-merge", options.plane_merge, "Which planes become one, by which rule")
      ->type_name("RULE")
      ->check(CLI::IsMember({"default", "paper"}))
      ->capture_default_str();
  command
      .add_option("--plane-fit", options.plane_fit,
                  "Graph-cut RANSAC, or plain: sequential RANSAC without spatial coherence")
      ->type_name("METHOD")
      ->check(CLI::IsMember({"graph-cut", "plain"}))
      ->capture_default_str();
  command.add_flag("--no-planes", options.no_planes, "Map points alone");
  command.add_flag("--no-joint-refinement", options.no_joint_refinement,
                   "No final refinement of points and planes together");
}

engine::TrackSequenceOptions TrackingOptions::resolve(const CommonOptions& common,
                                                      const InputOptions& input) const {
  engine::TrackSequenceOptions result;
  result.mode = mode;
  result.segmentation = segmentation;
  result.network = network;
  result.mask_leakage = mask_leakage;
  result.causal = causal;
  result.close_loops = !no_loop_closing;
  result.threads = common.threads;
  result.seed = common.seed;
  result.skip_unreadable = input.skip_unreadable;
  result.plane_merge = plane_merge;
  result.plane_fit = plane_fit;
  result.map_planes = !no_planes;
  result.refine_jointly = !no_joint_refinement;
  if (!up.empty()) result.up = parse_direction(up);
  return result;
}

engine::Reconstruction track_with_progress(engine::Sequence& sequence,
                                           const engine::TrackSequenceOptions& options,
                                           const Console& console) {
  for (const std::string& warning : sequence.warnings()) console.warning(warning);
  ProgressBar bar(console, "tracking");
  engine::Reconstruction reconstruction = engine::track_sequence(
      sequence, options, [&bar](int done, int total) { bar.update(done, total); });
  bar.finish();
  console.info("plane masks: " + reconstruction.segmentation);
  return reconstruction;
}

TrackingReport report_tracking(const engine::Reconstruction& reconstruction, bool causal) {
  TrackingReport report;
  report.frames = static_cast<int>(reconstruction.frames.size());
  for (const engine::FrameRecord& frame : reconstruction.frames) {
    if (causal ? frame.causal_world_from_cam : frame.world_from_cam) ++report.posed;
  }
  report.poor = 2 * report.posed < report.frames;
  char text[160];
  std::snprintf(text, sizeof(text),
                "%d of %d frames have a pose, %zu keyframes, %zu planes, %zu points", report.posed,
                report.frames, reconstruction.keyframes.size(), reconstruction.planes.size(),
                reconstruction.points.size());
  report.line = text;
  return report;
}

}  // namespace planecast::app
