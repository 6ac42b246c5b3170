#include "engine/scene/scene_file.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "engine/scene/yaml_map.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kPlaneRules = {"largest-horizontal", "largest-vertical",
                                                         "floor", "nearest"};

Eigen::Vector2d to_vector2(const std::vector<double>& v) { return {v[0], v[1]}; }
Eigen::Vector3d to_vector3(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

double positive(YamlMap& map, const std::string& key, double value) {
  if (value <= 0.0) map.fail(key, "'" + key + "' must be positive");
  return value;
}

fs::path find_model(YamlMap& map, const fs::path& scene_path) {
  const std::optional<std::string> text = map.text("model");
  if (!text) map.fail("model", "object without 'model'");
  const fs::path given(*text);
  std::error_code ignored;
  const fs::path beside = given.is_absolute() ? given : scene_path.parent_path() / given;
  if (fs::is_regular_file(beside, ignored)) return beside;
  if (fs::is_regular_file(given, ignored)) return given;
  map.fail("model", "model '" + *text + "' not found");
}

PixelPlace read_pixel_place(YamlMap& map) {
  PixelPlace place;
  const std::optional<int> frame = map.integer("frame");
  const auto pixel = map.numbers("pixel", 2);
  if (!frame || !pixel) map.fail("frame", "'place' needs both 'frame' and 'pixel'");
  if (*frame < 0) map.fail("frame", "'frame' must not be negative");
  place.frame = *frame;
  place.pixel = to_vector2(*pixel);
  return place;
}

PlanePlace read_plane_place(YamlMap& map) {
  PlanePlace place;
  place.plane = *map.text("plane");
  int id = 0;
  const char* end = place.plane.data() + place.plane.size();
  const auto parsed = std::from_chars(place.plane.data(), end, id);
  const bool is_id = parsed.ec == std::errc() && parsed.ptr == end && id >= 0;
  if (!is_id && std::ranges::find(kPlaneRules, place.plane) == kPlaneRules.end()) {
    map.fail("plane",
             "'plane' must be an id, largest-horizontal, largest-vertical, floor or nearest");
  }
  if (const auto at = map.numbers("at", 2)) {
    place.at = to_vector2(*at);
    if ((place.at.array() < 0.0).any() || (place.at.array() > 1.0).any()) {
      map.fail("at", "'at' is a fraction: both numbers must lie between 0 and 1");
    }
  }
  return place;
}

PointPlace read_point_place(YamlMap& map) {
  PointPlace place;
  place.position = to_vector3(*map.numbers("position", 3));
  if (const auto normal = map.numbers("normal", 3)) {
    place.normal = to_vector3(*normal);
    if (place.normal.norm() < 1e-9) map.fail("normal", "'normal' must not be zero");
    place.normal.normalize();
  }
  return place;
}

Place read_place(YamlMap& object) {
  std::optional<YamlMap> map = object.map("place");
  if (!map) object.fail("place", "object without 'place'");
  Place place;
  if (map->has("plane")) {
    place = read_plane_place(*map);
  } else if (map->has("position")) {
    place = read_point_place(*map);
  } else if (map->has("frame") || map->has("pixel")) {
    place = read_pixel_place(*map);
  } else {
    map->finish();
    object.fail("place", "'place' needs 'frame' and 'pixel', or 'plane', or 'position'");
  }
  map->finish();
  return place;
}

void read_animation(YamlMap& map, SceneObject& object) {
  const std::optional<std::string> text = map.text("animation");
  if (!text) return;
  int index = 0;
  const char* end = text->data() + text->size();
  const auto parsed = std::from_chars(text->data(), end, index);
  if (parsed.ec == std::errc() && parsed.ptr == end && index >= 0) {
    object.animation_index = index;
  } else {
    object.animation = *text;
  }
}

SceneObject read_object(const YAML::Node& node, const std::string& file, const fs::path& path) {
  YamlMap map(node, file, "object");
  SceneObject object;
  object.where = file + ":" + std::to_string(map.line());
  object.model = find_model(map, path);
  object.place = read_place(map);
  if (const auto size = map.number("size")) object.size = positive(map, "size", *size);
  object.yaw_deg = map.number("yaw").value_or(0.0);
  if (map.choice("face", {"camera", "keep"}).value_or("camera") == "keep")
    object.face = Face::kKeep;
  read_animation(map, object);
  map.finish();
  return object;
}

/// `name: 1.5`, or `color` (linear RGB, default white) times `intensity`.
Eigen::Vector3d read_radiance(YamlMap& map, double default_intensity) {
  Eigen::Vector3d color = Eigen::Vector3d::Ones();
  if (const auto given = map.numbers("color", 3)) color = to_vector3(*given);
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
    if (const auto direction = sun->numbers("direction", 3)) {
      light.sun_direction = to_vector3(*direction);
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

EdgeScale read_edge(YamlMap& edge) {
  EdgeScale scale;
  const auto frame = edge.integer("frame");
  const auto from = edge.numbers("from", 2);
  const auto to = edge.numbers("to", 2);
  const auto length = edge.number("length");
  if (!frame || !from || !to || !length) {
    edge.fail("frame", "'edge' needs 'frame', 'from', 'to' and 'length'");
  }
  scale.frame = *frame;
  scale.from = to_vector2(*from);
  scale.to = to_vector2(*to);
  scale.length_m = positive(edge, "length", *length);
  edge.finish();
  return scale;
}

std::optional<ScaleHint> read_scale(YamlMap& root, const std::string& file) {
  std::optional<YamlMap> map = root.map("scale");
  if (!map) return std::nullopt;
  ScaleHint hint;
  hint.where = file + ":" + std::to_string(root.line_of("scale"));
  if (std::optional<YamlMap> edge = map->map("edge")) {
    hint.rule = read_edge(*edge);
  } else if (const auto distance = map->number("plane_distance")) {
    PlaneDistanceScale rule;
    rule.distance_m = positive(*map, "plane_distance", *distance);
    rule.frame = map->integer("frame");
    hint.rule = rule;
  } else {
    map->finish();
    root.fail("scale", "'scale' needs 'plane_distance' or 'edge'");
  }
  map->finish();
  return hint;
}

}  // namespace

SceneFile read_scene_file(const fs::path& path) {
  SceneFile scene;
  scene.name = path.string();
  YAML::Node node;
  try {
    node = YAML::LoadFile(scene.name);
  } catch (const YAML::BadFile&) {
    throw UserError(scene.name + ": cannot be read");
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw UserError(scene.name + line + ": not valid YAML (" + error.msg + ")");
  }
  YamlMap root(node, scene.name, "a scene");
  scene.light = read_light(root);
  scene.shadows = root.boolean("shadows").value_or(true);
  scene.occlusion = read_occlusion(root);
  const YAML::Node objects = root.node("objects");
  if (!objects || !objects.IsSequence() || objects.size() == 0) {
    root.fail("objects", "'objects' must be a list of at least one object");
  }
  for (const auto& object : objects) {
    scene.objects.push_back(read_object(object, scene.name, path));
  }
  scene.scale = read_scale(root, scene.name);
  root.finish();
  return scene;
}

}  // namespace planecast::engine
