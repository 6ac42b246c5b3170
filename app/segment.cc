#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/cancel.h"
#include "engine/segmentation/choose_segmenter.h"
#include "engine/segmentation/mask_files.h"
#include "engine/sequence/image_file.h"
#include "engine/user_error.h"

namespace planecast::app {
namespace {

struct SegmentCommand {
  CommonOptions common;
  InputOptions input;
  std::string segmentation = "auto";
  std::string network;
  std::string output;
  bool overlay = false;

  int run() const {
    const Console console = common.console();
    const std::filesystem::path path(input.sequence);
    std::error_code ignored;
    const bool one_image =
        engine::has_image_suffix(path) && !std::filesystem::is_directory(path, ignored);
    const engine::MaskFolder masks = one_image ? segment_image(console) : segment_sequence(console);
    nlohmann::ordered_json figures;
    figures["output"] = output;
    figures["segmentation"] = masks.segmenter();
    figures["masks"] = nlohmann::ordered_json::array();
    for (const engine::MaskRecord& mask : masks.masks()) {
      figures["masks"].push_back({{"frame", mask.frame},
                                  {"timestamp", mask.timestamp},
                                  {"file", mask.file},
                                  {"instances", mask.instances}});
    }
    figures["interrupted"] = engine::cancel_requested();
    common.print_result(masks.finish().string(), figures);
    engine::throw_if_cancelled("mask.txt lists the masks that were made");
    return kDone;
  }

 private:
  engine::MaskFolder segment_image(const Console& console) const {
    if (segmentation != "auto" && segmentation != "network") {
      throw engine::UserError(input.sequence + ": --segmentation " + segmentation +
                              " needs a sequence; an image takes network");
    }
    slam::FrameInput frame;
    frame.image = engine::read_color_image(input.sequence);
    const auto segmenter = engine::choose_network(network);
    console.info("plane masks: " + segmenter->name());
    engine::MaskFolder masks(output, segmenter->name(), overlay);
    masks.add(0, 0.0, frame.image, segmenter->segment(frame));
    return masks;
  }

  engine::MaskFolder segment_sequence(const Console& console) const {
    const std::unique_ptr<engine::Sequence> sequence = input.open();
    for (const std::string& warning : sequence->warnings()) console.warning(warning);
    const auto segmenter =
        engine::choose_segmenter({segmentation, network}, *sequence, sequence->has_depth());
    console.info("plane masks: " + segmenter->name());
    engine::MaskFolder masks(output, segmenter->name(), overlay);
    ProgressBar bar(console, "segmenting");
    for (int index = sequence->first_frame(); index < sequence->end_frame(); ++index) {
      if (engine::cancel_requested()) break;
      const slam::FrameInput frame = sequence->read(index);
      masks.add(index, frame.timestamp, frame.image, segmenter->segment(frame));
      bar.update(index + 1 - sequence->first_frame(),
                 sequence->end_frame() - sequence->first_frame());
    }
    return masks;
  }
};

}  // namespace

void add_segment(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("segment", "Plane instance masks of a sequence or an image");
  auto options = std::make_shared<SegmentCommand>();
  add_input_options(*command, options->input);
  command->add_option("-o,--output", options->output, "Folder to write")
      ->type_name("DIR")
      ->required();
  add_json_option(*command, options->common);
  add_segmentation_options(*command, options->segmentation, options->network);
  command->add_flag("--overlay", options->overlay, "Also write the pictures with coloured planes");
  add_common_options(*command, options->common);
  set_examples(
      *command,
      {{"planecast segment desk -o out/masks", "Masks from the sequence's depth"},
       {"planecast segment desk --frames 120:121 -o out/masks", "Of one frame"},
       {"planecast segment desk.jpg --overlay -o out/masks", "Of one picture, by the network"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
