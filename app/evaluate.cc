#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/evaluate/masks.h"
#include "engine/evaluate/overlay.h"
#include "engine/evaluate/planes.h"
#include "engine/evaluate/tracks.h"
#include "engine/evaluate/trajectory.h"
#include "engine/evaluate/truth.h"
#include "engine/pipeline/reconstruction_io.h"
#include "engine/sequence/groundtruth.h"
#include "engine/user_error.h"

namespace planecast::app {
namespace {

namespace fs = std::filesystem;

struct EvaluateCommand {
  CommonOptions common;
  std::string estimate;
  std::string groundtruth;
  std::string reconstruction;
  std::string align;  ///< empty: by the reconstruction's scale; sim3 for trajectories
  bool causal = false;
  InputOptions input;            ///< of tracks
  engine::TrackOptions anchors;  ///< of tracks

  int trajectory() const;
  int planes() const;
  int overlay() const;
  int masks() const;
  int tracks() const;

 private:
  template <typename Result>
  int print(const std::optional<Result>& result) const;
  template <typename Result>
  int print_found(const Result& result) const;
  engine::TrajectoryOptions alignment(bool metric) const;
};

engine::TrajectoryOptions EvaluateCommand::alignment(bool metric) const {
  engine::TrajectoryOptions options;
  const bool rigid = align.empty() ? metric : align == "se3";
  options.align = rigid ? engine::Alignment::kSe3 : engine::Alignment::kSim3;
  return options;
}

template <typename Result>
int EvaluateCommand::print(const std::optional<Result>& result) const {
  if (!result) {
    throw engine::UserError(groundtruth +
                            ": fewer than 3 poses of the estimate have a counterpart in time");
  }
  return print_found(*result);
}

template <typename Result>
int EvaluateCommand::print_found(const Result& result) const {
  std::string table = engine::format_table(result);
  while (!table.empty() && table.back() == '\n') table.pop_back();
  common.print_result(table, engine::to_json(result));
  return kDone;
}

int EvaluateCommand::trajectory() const {
  return print(engine::evaluate_trajectory(
      engine::read_trajectory(estimate), engine::read_groundtruth(groundtruth), alignment(false)));
}

/// Of a sequence with exact poses and planes.
engine::SequenceTruth read_truth(const std::string& folder) {
  engine::SequenceTruth truth = engine::read_sequence_truth(folder, {});
  if (truth.planes.empty()) throw engine::UserError(folder + ": has no planes.json");
  return truth;
}

int EvaluateCommand::planes() const {
  const engine::Reconstruction map = engine::read_reconstruction(reconstruction);
  const engine::SequenceTruth truth = read_truth(groundtruth);
  engine::PlaneEvaluationOptions options;
  options.trajectory = alignment(map.metric);
  options.seen_labels = truth.seen_labels;
  return print(engine::evaluate_planes(map, truth.planes, truth.poses, truth.camera, options));
}

int EvaluateCommand::overlay() const {
  const engine::Reconstruction map = engine::read_reconstruction(reconstruction);
  const engine::SequenceTruth truth = read_truth(groundtruth);
  engine::OverlayOptions options;
  options.planes.trajectory = alignment(map.metric);
  options.causal = causal;
  return print(engine::evaluate_overlay(map, truth.planes, truth.poses, truth.camera, options));
}

int EvaluateCommand::masks() const {
  const auto truth = engine::open_sequence(groundtruth, {});
  return print_found(engine::evaluate_masks(estimate, *truth));
}

int EvaluateCommand::tracks() const {
  const engine::Reconstruction map = engine::read_reconstruction(reconstruction);
  const std::unique_ptr<engine::Sequence> sequence = input.open();
  return print_found(engine::evaluate_tracks(map, *sequence, anchors));
}

void add_shared_options(CLI::App& command, EvaluateCommand& options) {
  command
      .add_option("--align", options.align,
                  "Rigidly, or with a scale (default: sim3, or se3 for metric maps)")
      ->type_name("GROUP")
      ->check(CLI::IsMember({"se3", "sim3"}));
  add_json_option(command, options.common);
  add_common_options(command, options.common);
}

void add_masks_command(CLI::App& evaluate, std::shared_ptr<EvaluateCommand> options,
                       Action& action) {
  CLI::App* masks = evaluate.add_subcommand("masks", "Plane instance masks");
  masks->add_option("--estimate", options->estimate, "Folder with mask.txt, as `segment` writes it")
      ->type_name("DIR")
      ->required();
  masks->add_option("--groundtruth", options->groundtruth, "Sequence with true masks")
      ->type_name("DIR")
      ->required();
  add_json_option(*masks, options->common);
  add_common_options(*masks, options->common);
  set_examples(*masks, {{"planecast evaluate masks --estimate out/masks --groundtruth tabletop",
                         "Masks of `planecast segment` against the sequence's own"}});
  masks->callback([options, &action] { action = [options] { return options->masks(); }; });
}

void add_tracks_command(CLI::App& evaluate, std::shared_ptr<EvaluateCommand> options,
                        Action& action) {
  CLI::App* tracks = evaluate.add_subcommand(
      "tracks", "How anchored points keep to the picture's texture, without a truth");
  tracks->add_option("--reconstruction", options->reconstruction, "Reconstruction folder")
      ->required();
  add_input_options(*tracks, options->input);
  tracks->add_option("--frame", options->anchors.frame, "Frame where the points are anchored");
  tracks->add_option("--plane", options->anchors.plane, "Plane id or rule (as in scene files)");
  tracks->add_option("--points", options->anchors.points, "How many")->capture_default_str();
  add_json_option(*tracks, options->common);
  add_common_options(*tracks, options->common);
  set_examples(*tracks, {{"planecast evaluate tracks desk --reconstruction out/map",
                          "Whether content would slide, for recordings without a truth"}});
  tracks->callback([options, &action] { action = [options] { return options->tracks(); }; });
}

}  // namespace

void add_evaluate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("evaluate", "Compare results with the truth");
  command->require_subcommand(1);
  auto options = std::make_shared<EvaluateCommand>();

  CLI::App* trajectory =
      command->add_subcommand("trajectory", "Absolute and relative trajectory error");
  trajectory->add_option("--estimate", options->estimate, "Trajectory, TUM format")
      ->type_name("FILE")
      ->required();
  trajectory
      ->add_option("--groundtruth", options->groundtruth,
                   "True poses: a file of TUM, ICL-NUIM or EuRoC, or the sequence's folder")
      ->type_name("FILE")
      ->required();
  add_shared_options(*trajectory, *options);
  set_examples(
      *trajectory,
      {{"planecast evaluate trajectory --estimate out/map/trajectory.txt --groundtruth desk",
        "With a scale, as a monocular map has none of its own"},
       {"planecast evaluate trajectory --estimate t.txt --groundtruth desk --align se3 "
        "--json -",
        "Rigidly, as JSON on standard output"}});
  trajectory->callback(
      [options, &action] { action = [options] { return options->trajectory(); }; });

  const auto add_map_command = [&](const char* name, const char* what,
                                   int (EvaluateCommand::*run)() const) {
    CLI::App* sub = command->add_subcommand(name, what);
    sub->add_option("--reconstruction", options->reconstruction, "Reconstruction folder")
        ->type_name("DIR")
        ->required();
    sub->add_option("--groundtruth", options->groundtruth,
                    "Synthetic sequence with groundtruth.txt and planes.json")
        ->type_name("DIR")
        ->required();
    add_shared_options(*sub, *options);
    set_examples(*sub, {{std::string("planecast evaluate ") + name +
                             " --reconstruction out/map --groundtruth tabletop",
                         "A sequence of `planecast synth` knows its truth"}});
    sub->callback(
        [options, run, &action] { action = [options, run] { return (*options.*run)(); }; });
    return sub;
  };
  add_map_command("planes", "Planes found, missed and wrong", &EvaluateCommand::planes);
  add_map_command("overlay", "Drift and jitter of content in pixels", &EvaluateCommand::overlay)
      ->add_flag("--causal", options->causal, "Judge the poses as they were known at their frames");
  add_masks_command(*command, options, action);
  add_tracks_command(*command, options, action);
}

}  // namespace planecast::app
