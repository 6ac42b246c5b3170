#include <algorithm>
#include <memory>
#include <system_error>

#include "app/commands.h"
#include "app/inspect_window.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/assets.h"
#include "engine/inspect/screen.h"
#include "engine/output/png.h"
#include "engine/pipeline/reconstruction_io.h"
#include "engine/sequence/frame_options.h"
#include "engine/user_error.h"

namespace planecast::app {
namespace {

namespace fs = std::filesystem;

struct InspectCommand {
  CommonOptions common;
  std::string reconstruction;
  std::string sequence;
  std::string scene;
  std::string screenshot;
  std::string size = "1280x800";
  int frame = -1;

  int run() const;

 private:
  std::unique_ptr<engine::Sequence> open(const slam::Camera& camera) const;
  fs::path scene_path() const;
  std::vector<engine::TimingRow> timings() const;
};

/// The sequence at the size at which it was tracked.
std::unique_ptr<engine::Sequence> InspectCommand::open(const slam::Camera& camera) const {
  if (sequence.empty()) return nullptr;
  engine::SequenceOptions options;
  options.size = cv::Size(camera.width, camera.height);
  return engine::open_sequence(sequence, options);
}

fs::path InspectCommand::scene_path() const {
  return scene.empty() ? fs::path(reconstruction) / "scene.yaml" : fs::path(scene);
}

std::vector<engine::TimingRow> InspectCommand::timings() const {
  const fs::path path = fs::path(reconstruction) / "timings.json";
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  return engine::read_timings_json(path);
}

/// Our own models, then those of the scene.
std::vector<fs::path> models_to_place(const engine::SceneFile& scene) {
  std::vector<fs::path> models;
  for (const auto& entry : fs::directory_iterator(engine::asset("models"))) {
    if (entry.path().extension() == ".glb") models.push_back(entry.path());
  }
  std::ranges::sort(models);
  for (const engine::SceneObject& object : scene.objects) {
    std::error_code ignored;
    if (object.poster) continue;
    const bool listed = std::ranges::any_of(models, [&](const fs::path& model) {
      return model == object.model || fs::equivalent(model, object.model, ignored);
    });
    if (!listed) models.push_back(object.model);
  }
  return models;
}

int InspectCommand::run() const {
  engine::Reconstruction map = engine::read_reconstruction(reconstruction);
  if (map.frames.empty()) throw engine::UserError(reconstruction + ": has no frames");
  std::unique_ptr<engine::Sequence> frames = open(map.camera);
  const double fps = frames ? frames->fps() : 30.0;
  engine::SceneFile objects;
  std::error_code ignored;
  if (!scene.empty() || fs::exists(scene_path(), ignored)) {
    objects = engine::read_scene_file(scene_path());
  }
  const engine::MarkerMap markers =
      frames ? engine::find_markers(*frames, map, engine::markers_of(objects))
             : engine::MarkerMap{};
  engine::InspectSession session(std::move(map), objects, scene_path(), models_to_place(objects),
                                 markers);
  if (frame >= 0) session.go_to_frame(frame);
  engine::FramePictures pictures(session, std::move(frames));
  engine::InspectWindow window(session, timings(), fps);
  engine::InspectScreen screen(window, pictures);
  const cv::Size pixels = engine::parse_size(size);
  if (screenshot.empty()) {
    show_window(window, screen, pixels, "Planecast: " + reconstruction);
    return kDone;
  }
  engine::write_png(engine::inspect_screenshot(screen, pixels.width, pixels.height), screenshot);
  common.console().result(screenshot);
  return kDone;
}

}  // namespace

void add_inspect(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("inspect", "Look at a reconstruction and edit its scene, in a window");
  auto options = std::make_shared<InspectCommand>();
  command->add_option("reconstruction", options->reconstruction, "Reconstruction folder")
      ->type_name("DIR")
      ->required();
  command->add_option("--sequence", options->sequence, "The sequence it was made of, for pictures")
      ->type_name("SEQUENCE");
  command
      ->add_option("--scene", options->scene,
                   "Scene file to edit (default: scene.yaml of the reconstruction)")
      ->type_name("FILE");
  command->add_option("--frame", options->frame, "Frame to begin with")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--size", options->size, "Window's size WxH")
      ->type_name("WxH")
      ->capture_default_str();
  command
      ->add_option("--screenshot", options->screenshot,
                   "Write what the window would show as PNG; needs no display")
      ->type_name("FILE");
  add_common_options(*command, options->common);
  set_examples(*command, {{"planecast inspect out/mine --sequence desk", "Frames, map and tables"},
                          {"planecast inspect out/mine --screenshot out/mine.png",
                           "What the window would show, without a display"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
