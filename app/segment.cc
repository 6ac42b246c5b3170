#include <cstdio>
#include <memory>
#include <opencv2/core.hpp>

#include "app/commands.h"
#include "app/options.h"
#include "engine/output/atomic_file.h"
#include "engine/output/png.h"
#include "engine/output/trajectory.h"
#include "engine/user_error.h"
#include "slam/segmentation/plane_segmenter.h"

namespace planecast::app {
namespace {

std::unique_ptr<slam::PlaneSegmenter> make_segmenter(const engine::Sequence& sequence,
                                                     const std::string& wish) {
  const bool masks = wish == "masks" || (wish == "auto" && !sequence.has_depth());
  if (masks && sequence.has_labels()) return slam::make_mask_segmenter();
  if (!masks && sequence.has_depth()) return slam::make_depth_segmenter(sequence.camera());
  throw engine::UserError(sequence.path().string() + ": segmentation by " +
                          (masks ? "masks needs mask.txt" : "depth needs depth images") +
                          ", and there is none");
}

struct SegmentCommand {
  CommonOptions common;
  InputOptions input;
  std::string segmentation = "auto";
  std::string output;

  int run() const {
    const Console console = common.console();
    const std::unique_ptr<engine::Sequence> sequence = input.open();
    const auto segmenter = make_segmenter(*sequence, segmentation);
    const std::filesystem::path folder(output);
    engine::make_folder(folder / "mask");
    std::string list =
        "# plane instance masks by " + segmenter->name() + "\n# timestamp filename\n";
    {
      ProgressBar bar(console, "segmenting");
      for (int index = sequence->first_frame(); index < sequence->end_frame(); ++index) {
        const slam::FrameInput frame = sequence->read(index);
        char name[32];
        std::snprintf(name, sizeof(name), "mask/%06d.png", index);
        write_mask(*segmenter, frame, folder / name);
        list += engine::format_timestamp(frame.timestamp) + " " + name + "\n";
        bar.update(index + 1 - sequence->first_frame(),
                   sequence->end_frame() - sequence->first_frame());
      }
    }
    engine::write_file(folder / "mask.txt", list);
    console.result((folder / "mask.txt").string());
    return kDone;
  }

 private:
  /// 8 bits as long as the instances fit.
  static void write_mask(slam::PlaneSegmenter& segmenter, const slam::FrameInput& frame,
                         const std::filesystem::path& path) {
    cv::Mat labels = segmenter.segment(frame);
    if (labels.empty()) labels = cv::Mat::zeros(frame.image.size(), CV_16UC1);
    double most = 0.0;
    cv::minMaxLoc(labels, nullptr, &most);
    if (most < 256.0) labels.convertTo(labels, CV_8U);
    engine::write_png(labels, path);
  }
};

}  // namespace

void add_segment(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("segment", "Plane instance masks of a sequence");
  auto options = std::make_shared<SegmentCommand>();
  add_input_options(*command, options->input);
  command->add_option("-o,--output", options->output, "Folder to write")->required();
  command->add_option("--segmentation", options->segmentation, "auto, depth or masks")
      ->check(CLI::IsMember({"auto", "depth", "masks"}))
      ->capture_default_str();
  add_common_options(*command, options->common);
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
