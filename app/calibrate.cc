#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/calibrate/calibrate.h"
#include "engine/marker_dictionary.h"
#include "engine/output/png.h"
#include "engine/sequence/camera_file.h"
#include "engine/user_error.h"

namespace planecast::app {
namespace {

/// A board for printing is so many pixels wide: A4 at 300 dots an inch, with margins.
constexpr int kPrintWidth = 3000;

struct CalibrateCommand {
  CommonOptions common;
  std::string recording;
  std::string frames;
  std::string squares = "10x7";
  std::string board = "chessboard";
  std::string model = "pinhole";
  std::string output = "camera.yaml";
  std::string draw_board;
  engine::BoardSpec spec;
  engine::CalibrateOptions options;

  int run() {
    spec.kind = board == "charuco" ? engine::BoardKind::kCharuco : engine::BoardKind::kChessboard;
    parse_squares();
    options.lens = model == "fisheye" ? slam::LensModel::kFisheye : slam::LensModel::kPinhole;
    if (!draw_board.empty()) return draw();
    if (recording.empty()) throw engine::UserError("calibrate: no recording named");
    return calibrate();
  }

 private:
  void parse_squares() {
    char rest = 0;
    if (std::sscanf(squares.c_str(), "%dx%d%c", &spec.columns, &spec.rows, &rest) != 2) {
      throw engine::UserError("--squares " + squares + ": expected COLUMNSxROWS, as 10x7");
    }
  }

  int draw() const {
    const int square_px = std::max(kPrintWidth / std::max(spec.columns, spec.rows), 8);
    engine::write_png(engine::BoardDetector(spec).draw(square_px), draw_board);
    common.console().result(draw_board);
    return kDone;
  }

  int calibrate() const {
    const Console console = common.console();
    InputOptions input;
    input.sequence = recording;
    input.frames = frames;
    const std::unique_ptr<engine::Sequence> sequence = input.open();
    engine::Calibration result;
    {
      ProgressBar bar(console, "looking");
      result = engine::calibrate_camera(*sequence, spec, options,
                                        [&bar](int done, int total) { bar.update(done, total); });
    }
    for (const std::string& warning : result.warnings) console.warning(warning);
    engine::CameraSettings settings;
    settings.camera = result.camera;
    engine::write_camera_file(output, settings, engine::format_table(result));
    console.info(engine::format_table(result));
    nlohmann::ordered_json figures = engine::to_json(result);
    figures["output"] = output;
    common.print_result(output, figures);
    return kDone;
  }
};

}  // namespace

void add_calibrate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "calibrate", "Camera file from a recording of a chessboard or a ChArUco board");
  auto options = std::make_shared<CalibrateCommand>();
  command->add_option("recording", options->recording, "Video file or image folder")
      ->type_name("SEQUENCE");
  command->add_option("-o,--output", options->output, "Camera file to write")
      ->type_name("FILE")
      ->capture_default_str();
  command->add_option("--board", options->board, "What the board is")
      ->type_name("KIND")
      ->check(CLI::IsMember({"chessboard", "charuco"}))
      ->capture_default_str();
  command->add_option("--squares", options->squares, "Squares (not inner corners) of the board")
      ->type_name("COLUMNSxROWS")
      ->capture_default_str();
  command->add_option("--model", options->model, "Lens; fisheye for more than about 100 degrees")
      ->type_name("LENS")
      ->check(CLI::IsMember({"pinhole", "fisheye"}))
      ->capture_default_str();
  command
      ->add_option("--marker", options->spec.marker_share,
                   "ChArUco: side of a marker, of a square's")
      ->type_name("N")
      ->check(CLI::Range(0.1, 0.95))
      ->capture_default_str();
  command->add_option("--dictionary", options->spec.dictionary, "ChArUco: its markers")
      ->type_name("NAME")
      ->check(CLI::IsMember(engine::marker_dictionary_names()))
      ->capture_default_str();
  command->add_option("--frames", options->frames, "Frames A to B, counted from 0, B excluded")
      ->type_name("A:B");
  command->add_option("--most-frames", options->options.most_frames, "Frames to look at, spread")
      ->type_name("N")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  command->add_option("--most-views", options->options.most_views, "Views of the board to use")
      ->type_name("N")
      ->check(CLI::Range(3, 500))
      ->capture_default_str();
  command->add_option("--draw-board", options->draw_board, "Only write the board, to be printed")
      ->type_name("FILE");
  add_json_option(*command, options->common);
  add_console_options(*command, options->common);
  set_examples(*command,
               {{"planecast calibrate --draw-board board.png --board charuco --squares 10x7",
                 "A board to print; glue it on something flat"},
                {"planecast calibrate board.mp4 --board charuco --squares 10x7 -o phone.yaml",
                 "The camera that recorded it"},
                {"planecast calibrate shots --squares 10x7 --model fisheye -o action.yaml",
                 "A wide lens, from pictures of a chessboard of 9x6 inner corners"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
