#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "app/commands.h"
#include "app/options.h"
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
    console.result(one_image ? segment_image(console) : segment_sequence(console));
    return kDone;
  }

 private:
  std::string segment_image(const Console& console) const {
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
    return masks.finish().string();
  }

  std::string segment_sequence(const Console& console) const {
    const std::unique_ptr<engine::Sequence> sequence = input.open();
    for (const std::string& warning : sequence->warnings()) console.warning(warning);
    const auto segmenter =
        engine::choose_segmenter({segmentation, network}, *sequence, sequence->has_depth());
    console.info("plane masks: " + segmenter->name());
    engine::MaskFolder masks(output, segmenter->name(), overlay);
    ProgressBar bar(console, "segmenting");
    for (int index = sequence->first_frame(); index < sequence->end_frame(); ++index) {
      const slam::FrameInput frame = sequence->read(index);
      masks.add(index, frame.timestamp, frame.image, segmenter->segment(frame));
      bar.update(index + 1 - sequence->first_frame(),
                 sequence->end_frame() - sequence->first_frame());
    }
    return masks.finish().string();
  }
};

}  // namespace

void add_segment(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("segment", "Plane instance masks of a sequence or an image");
  auto options = std::make_shared<SegmentCommand>();
  add_input_options(*command, options->input);
  command->add_option("-o,--output", options->output, "Folder to write")->required();
  add_segmentation_options(*command, options->segmentation, options->network);
  command->add_flag("--overlay", options->overlay, "Also write the pictures with coloured planes");
  add_common_options(*command, options->common);
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
