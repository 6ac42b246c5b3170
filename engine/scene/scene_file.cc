#include "engine/scene/scene_file.h"

#include <algorithm>
#include <set>

#include "engine/scene/read_object.h"
#include "engine/scene/read_scale.h"
#include "engine/scene/yaml_map.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

/// `name: 1.5`, or `color` (linear RGB, default white) times `intensity`.
Eigen::Vector3d read_radiance(YamlMap& map, double default_intensity) {
  const Eigen::Vector3d color = map.vector3("color").value_or(Eigen::Vector3d::Ones());
  if (color.minCoeff() < 0.0) map.fail("color", "'color' must not be negative");
  const double intensity = map.number("intensity").value_or(default_intensity);
  if (intensity < 0.0) map.fail("intensity", "'intensity' must not be negative");
  return color * intensity;
}

std::optional<FixedLight> read_light(YamlMap& root) {
  const YAML::Node node = root.node("light");
  if (!node || (node.IsScalar() && node.Scalar() == "estimate")) return std::nullopt;
  if (!node.IsMap()) root.fail("light", "'light' must be estimate, or a sun and a sky");
  std::optional<YamlMap> map = root.map("light");
  FixedLight light;
  light.sun_direction.normalize();
  if (std::optional<YamlMap> sun = map->map("sun")) {
    if (const auto direction = sun->vector3("direction")) {
      light.sun_direction = *direction;
      if (light.sun_direction.norm() < 1e-9) sun->fail("direction", "'direction' must not be zero");
      light.sun_direction.normalize();
    }
    light.sun_radiance = read_radiance(*sun, light.sun_radiance.x());
    sun->finish();
  }
  if (map->node("sky").IsDefined() && map->node("sky").IsScalar()) {
    const double intensity = *map->number("sky");
    if (intensity < 0.0) map->fail("sky", "'sky' must not be negative");
    light.sky_radiance.setConstant(intensity);
  } else if (std::optional<YamlMap> sky = map->map("sky")) {
    light.sky_radiance = read_radiance(*sky, light.sky_radiance.x());
    sky->finish();
  }
  map->finish();
  return light;
}

Occlusion read_occlusion(YamlMap& root) {
  const std::string text =
      root.choice("occlusion", {"none", "planes", "depth", "both"}).value_or("planes");
  if (text == "none") return Occlusion::kNone;
  if (text == "depth") return Occlusion::kDepth;
  if (text == "both") return Occlusion::kBoth;
  return Occlusion::kPlanes;
}

Look read_look(YamlMap& root) {
  Look look;
  std::optional<YamlMap> map = root.map("look");
  if (!map) return look;
  look.grain = map->boolean("grain").value_or(look.grain);
  look.blur = map->boolean("blur").value_or(look.blur);
  look.exposure = map->boolean("exposure").value_or(look.exposure);
  look.lens = map->boolean("lens").value_or(look.lens);
  look.clean_edges = map->boolean("clean_edges").value_or(look.clean_edges);
  map->finish();
  return look;
}

/// Whoever stands on another stands after it, and names are unique.
void check_names(const SceneFile& scene) {
  std::set<std::string> names;
  for (const SceneObject& object : scene.objects) {
    const auto* place = std::get_if<ObjectPlace>(&object.place);
    if (place != nullptr && names.count(place->object) == 0) {
      throw UserError(object.where + ": no object before this one has the name '" + place->object +
                      "'");
    }
    if (!object.name.empty() && !names.insert(object.name).second) {
      throw UserError(object.where + ": the name '" + object.name + "' stands twice");
    }
  }
}

}  // namespace

SceneFile read_scene_file(const fs::path& path) {
  SceneFile scene;
  scene.name = path.string();
  YamlMap root(load_yaml_file(path), scene.name, "a scene");
  scene.light = read_light(root);
  scene.shadows = root.boolean("shadows").value_or(true);
  scene.occlusion = read_occlusion(root);
  scene.look = read_look(root);
  scene.keep_apart = root.boolean("keep_apart").value_or(true);
  scene.ease_frames = root.integer("ease").value_or(scene.ease_frames);
  if (scene.ease_frames < 0) root.fail("ease", "'ease' must not be negative");
  const YAML::Node objects = root.node("objects");
  if (!objects || !objects.IsSequence() || objects.size() == 0) {
    root.fail("objects", "'objects' must be a list of at least one object");
  }
  for (const auto& object : objects) {
    const std::vector<SceneObject> read = read_object(object, scene.name, path);
    scene.objects.insert(scene.objects.end(), read.begin(), read.end());
  }
  scene.scale = read_scale(root, scene.name);
  root.finish();
  check_names(scene);
  return scene;
}

std::vector<MarkerId> markers_of(const SceneFile& scene) {
  std::set<MarkerId> markers;
  for (const SceneObject& object : scene.objects) {
    if (const auto* place = std::get_if<MarkerPlace>(&object.place)) markers.insert(place->marker);
  }
  if (scene.scale) {
    if (const auto* rule = std::get_if<MarkerScale>(&scene.scale->rule)) {
      markers.insert(rule->marker);
    }
  }
  return {markers.begin(), markers.end()};
}

}  // namespace planecast::engine
