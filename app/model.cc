#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/commands.h"
#include "app/manual.h"
#include "app/options.h"
#include "engine/look/environment_file.h"
#include "engine/output/png.h"
#include "engine/pipeline/turntable.h"
#include "engine/user_error.h"
#include "render/gltf/import.h"

namespace planecast::app {
namespace {

struct ModelCommand {
  CommonOptions common;
  engine::TurntableOptions turntable;
  std::string file;
  std::string output;
  std::string animation;
  std::string environment;
  std::optional<double> time_s;
  render::ImportOptions import;
  bool list = false;
  bool keep_triangles = false;

  int run() const {
    const Console console = common.console();
    const render::ImportResult model = render::import_gltf(file, import);
    if (!model.model) throw engine::UserError(file + ": " + model.error);
    for (const std::string& warning : model.warnings) console.warning(file + ": " + warning);
    describe(*model.model, console);
    std::vector<std::string> lines;
    if (list) lines = render::describe_model(*model.model);
    if (!output.empty()) {
      draw(model.model);
      lines.push_back(output);
    }
    if (!lines.empty() || !common.json.empty()) {
      common.print_result(CLI::detail::join(lines, "\n"), figures(model));
    }
    return kDone;
  }

 private:
  void draw(const std::shared_ptr<const render::Model>& model) const {
    engine::TurntableOptions options = turntable;
    options.animation = find_animation(*model);
    options.time_s = time_s.value_or(0.0);
    options.simplify = !keep_triangles;
    if (!environment.empty()) options.environment = engine::load_environment(environment);
    if (options.camera >= 0 && !engine::has_camera(*model, options.camera)) {
      throw engine::UserError(file + ": no camera " + std::to_string(options.camera));
    }
    engine::write_png(engine::draw_turntable(model, options), output);
  }

  nlohmann::ordered_json figures(const render::ImportResult& imported) const {
    const render::Model& model = *imported.model;
    const render::Bounds bounds = render::model_bounds(model);
    nlohmann::ordered_json json;
    json["file"] = file;
    json["min"] = {bounds.min.x, bounds.min.y, bounds.min.z};
    json["max"] = {bounds.max.x, bounds.max.y, bounds.max.z};
    json["animations"] = nlohmann::ordered_json::array();
    const std::vector<std::string> names = render::animation_names(model);
    for (std::size_t i = 0; i < names.size(); ++i) {
      json["animations"].push_back(
          {{"name", names[i]},
           {"seconds", render::animation_duration_s(model, static_cast<int>(i))}});
    }
    json["contents"] = render::describe_model(model);
    json["warnings"] = imported.warnings;
    if (!output.empty()) json["picture"] = output;
    return json;
  }

  void describe(const render::Model& model, const Console& console) const {
    const render::Bounds bounds = render::model_bounds(model);
    char text[160];
    std::snprintf(text, sizeof(text), "size %.4g x %.4g x %.4g m, base at y = %.4g m",
                  static_cast<double>(bounds.max.x - bounds.min.x),
                  static_cast<double>(bounds.max.y - bounds.min.y),
                  static_cast<double>(bounds.max.z - bounds.min.z),
                  static_cast<double>(bounds.min.y));
    console.info(text);
    const std::vector<std::string> names = render::animation_names(model);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double seconds = render::animation_duration_s(model, static_cast<int>(i));
      std::snprintf(text, sizeof(text), "animation %zu '%s', %.2f s", i, names[i].c_str(), seconds);
      console.info(text);
    }
  }

  int find_animation(const render::Model& model) const {
    const std::vector<std::string> names = render::animation_names(model);
    if (animation.empty()) {
      if (!time_s) return -1;
      if (names.empty()) throw engine::UserError(file + ": no animation for --time");
      return 0;
    }
    const auto found = std::ranges::find(names, animation);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    // Many files leave their animations without names.
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (animation == std::to_string(i)) return static_cast<int>(i);
    }
    throw engine::UserError(file + ": no animation '" + animation + "'");
  }
};

}  // namespace

void add_model(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("model", "Describe a glTF model and draw it from around");
  auto options = std::make_shared<ModelCommand>();
  command->add_option("file", options->file, "glTF or GLB file")->type_name("FILE")->required();
  command->add_option("-o,--output", options->output, "PNG to write")->type_name("FILE");
  add_json_option(*command, options->common);
  command->add_option("--views", options->turntable.views, "Views around the model")
      ->type_name("N")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--view-size", options->turntable.view_size_px, "Side of a view in pixels")
      ->type_name("N")
      ->check(CLI::Range(32, 2048))
      ->capture_default_str();
  command
      ->add_option("--animation", options->animation,
                   "Name or number of an animation to pose it by")
      ->type_name("NAME|N");
  command
      ->add_option("--time", options->time_s,
                   "Seconds into the animation, without --animation the first (default: 0)")
      ->type_name("N");
  command->add_flag("--list", options->list, "Say what the file contains");
  command
      ->add_option("--scene", options->import.scene, "Scene by number instead of the default one")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--variant", options->import.variant, "Material variant by name")
      ->type_name("NAME");
  command->add_option("--camera", options->turntable.camera, "See through the model's own camera")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--elevation", options->turntable.elevation_deg, "Degrees over the horizon")
      ->type_name("N")
      ->check(CLI::Range(-89.0, 89.0))
      ->capture_default_str();
  command->add_option("--azimuth", options->turntable.azimuth_deg, "Degrees of the first view")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--environment", options->environment,
                   "Equirectangular .hdr picture of surroundings that light the model")
      ->type_name("FILE");
  command->add_flag("--keep-triangles", options->keep_triangles, "Never simplify meshes");
  add_common_options(*command, options->common);
  set_examples(*command,
               {{"planecast model robot.glb --list", "What it contains and what is not drawn"},
                {"planecast model robot.glb --views 8 -o robot.png", "Eight views around it"},
                {"planecast model robot.glb --animation Walk --time 0.6 -o step.png",
                 "A moment of an animation"}});
  command->callback([options, &action] { action = [options] { return options->run(); }; });
}

}  // namespace planecast::app
