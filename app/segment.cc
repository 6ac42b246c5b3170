#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>

#include "app/commands.h"
#include "app/manual.h"
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
  const std::string needs = wish == "masks"   ? "mask.txt"
                            : wish == "depth" ? "depth images"
                                              : "depth images or mask.txt";
  const bool one_picture = !std::filesystem::is_directory(sequence.path());
  throw engine::UserError(
      sequence.path().string() + ": segmentation needs " + needs +
      (one_picture ? "; give the folder that has them, and --frames for one picture of it"
                   : ", and there is none"));
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
    nlohmann::ordered_json figures;
    figures["output"] = output;
    figures["segmentation"] = segmenter->name();
    figures["masks"] = nlohmann::ordered_json::array();
    std::string list =
        "# plane instance masks by " + segmenter->name() + "\n# timestamp filename\n";
    {
      ProgressBar bar(console, "segmenting");
      for (int index = sequence->first_frame(); index < sequence->end_frame(); ++index) {
        const slam::FrameInput frame = sequence->read(index);
        char name[32];
        std::snprintf(name, sizeof(name), "mask/%06d.png", index);
        const int instances = write_mask(*segmenter, frame, folder / name);
        figures["masks"].push_back({{"frame", index},
                                    {"timestamp", frame.timestamp},
                                    {"file", name},
                                    {"instances", instances}});
        list += engine::format_timestamp(frame.timestamp) + " " + name + "\n";
        bar.update(index + 1 - sequence->first_frame(),
                   sequence->end_frame() - sequence->first_frame());
      }
    }
    engine::write_file(folder / "mask.txt", list);
    common.print_result((folder / "mask.txt").string(), figures);
    return kDone;
  }

 private:
  /// 8 bits as long as the instances fit. Returns how many there are.
  static int write_mask(slam::PlaneSegmenter& segmenter, const slam::FrameInput& frame,
                        const std::filesystem::path& path) {
    cv::Mat labels = segmenter.segment(frame);
    if (labels.empty()) labels = cv::Mat::zeros(frame.image.size(), CV_16UC1);
    double most = 0.0;
    cv::minMaxLoc(labels, nullptr, &most);
    if (most < 256.0) labels.convertTo(labels, CV_8U);
    engine::write_png(labels, path);
    std::set<int> values;
    cv::Mat wide;
    labels.convertTo(wide, CV_32S);
    for (const int value : cv::Mat_<int>(wide)) values.insert(value);
    values.erase(0);
    return static_cast<int>(values.size());
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
  command->add_option("--segmentation", options->segmentation, "What to find the planes by")
      ->type_name("HOW")
      ->check(CLI::IsMember({"auto", "depth", "masks"}))
      ->capture_default_str();
  add_common_options(*command, options->common);
  set_examples(*command,
               {{"planecast segment desk -o out/masks", "Masks from the sequence's depth"},
                {"planecast segment desk --frames 120:121 -o out/masks", "Of one frame"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
