#include "engine/scene/read_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "engine/marker_dictionary.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kPlaneRules = {"largest-horizontal", "largest-vertical",
                                                         "floor", "nearest"};

/// A whole number that is not negative, and nothing else.
std::optional<int> to_index(const std::string& text) {
  int value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || value < 0) return std::nullopt;
  return value;
}

fs::path find_file(YamlMap& map, const std::string& key, const fs::path& scene_path) {
  const std::string text = *map.text(key);
  const fs::path given(text);
  std::error_code ignored;
  const fs::path beside = given.is_absolute() ? given : scene_path.parent_path() / given;
  if (fs::is_regular_file(beside, ignored)) return beside;
  if (fs::is_regular_file(given, ignored)) return given;
  map.fail(key, key + " '" + text + "' not found");
}

PixelPlace read_pixel_place(YamlMap& map) {
  PixelPlace place;
  const std::optional<int> frame = map.integer("frame");
  const auto pixel = map.vector2("pixel");
  if (!frame || !pixel) map.fail("frame", "'place' needs both 'frame' and 'pixel'");
  if (*frame < 0) map.fail("frame", "'frame' must not be negative");
  place.frame = *frame;
  place.pixel = *pixel;
  return place;
}

PlanePlace read_plane_place(YamlMap& map) {
  PlanePlace place;
  place.plane = *map.text("plane");
  if (!to_index(place.plane) && std::ranges::find(kPlaneRules, place.plane) == kPlaneRules.end()) {
    map.fail("plane",
             "'plane' must be an id, largest-horizontal, largest-vertical, floor or nearest");
  }
  if (const auto at = map.vector2("at")) {
    place.at = *at;
    if ((place.at.array() < 0.0).any() || (place.at.array() > 1.0).any()) {
      map.fail("at", "'at' is a fraction: both numbers must lie between 0 and 1");
    }
  }
  return place;
}

PointPlace read_point_place(YamlMap& map) {
  PointPlace place;
  place.position = *map.vector3("position");
  if (const auto normal = map.vector3("normal")) {
    place.normal = *normal;
    if (place.normal.norm() < 1e-9) map.fail("normal", "'normal' must not be zero");
    place.normal.normalize();
  }
  return place;
}

void read_place(YamlMap& node, SceneObject& object) {
  std::optional<YamlMap> map = node.map("place");
  if (!map) node.fail("place", "object without 'place'");
  if (map->has("plane")) {
    object.place = read_plane_place(*map);
  } else if (map->has("position")) {
    object.place = read_point_place(*map);
  } else if (map->has("frame") || map->has("pixel")) {
    object.place = read_pixel_place(*map);
  } else if (std::optional<YamlMap> marker = map->map("marker")) {
    object.place = MarkerPlace{read_marker(*marker)};
    marker->finish();
  } else if (const auto on = map->text("on")) {
    object.place = ObjectPlace{*on};
  } else {
    map->finish();
    node.fail("place",
              "'place' needs 'frame' and 'pixel', or 'plane', or 'marker', or 'on', or 'position'");
  }
  if (const auto offset = map->vector3("offset")) object.offset = *offset;
  map->finish();
}

/// `size: 0.3`, or with its unit: `{metres: 0.3}`, `{relative: 0.3}`.
void read_size(YamlMap& map, SceneObject& object) {
  if (!map.has("size")) return;
  if (!map.node("size").IsMap()) {
    object.size = map.positive("size");
    return;
  }
  std::optional<YamlMap> size = map.map("size");
  const auto metres = size->positive("metres");
  const auto relative = size->positive("relative");
  size->finish();
  if (metres.has_value() == relative.has_value()) {
    map.fail("size", "'size' must be a number, or hold either 'metres' or 'relative'");
  }
  object.size = metres ? metres : relative;
  object.unit = metres ? LengthUnit::kMetres : LengthUnit::kRelative;
}

void read_animation(YamlMap& map, SceneObject& object) {
  if (const std::optional<std::string> text = map.text("animation")) {
    object.animation_index = to_index(*text);
    if (!object.animation_index) object.animation = *text;
  }
  object.loop = map.boolean("loop").value_or(true);
  object.start_s = map.number("start").value_or(0.0);
  if (object.start_s < 0.0) map.fail("start", "'start' must not be negative");
}

void read_poster(YamlMap& node, const fs::path& path, SceneObject& object) {
  std::optional<YamlMap> map = node.map("poster");
  Poster poster;
  poster.video = map->has("video");
  if (poster.video == map->has("image")) {
    node.fail("poster", "'poster' needs either 'image' or 'video'");
  }
  poster.file = find_file(*map, poster.video ? "video" : "image", path);
  object.size = map->positive("width");
  map->finish();
  object.poster = poster;
}

std::vector<SceneObject> read_instances(YamlMap& map, const std::string& file,
                                        const SceneObject& object) {
  const YAML::Node list = map.node("instances");
  if (!list) return {object};
  if (!list.IsSequence() || list.size() == 0) {
    map.fail("instances", "'instances' must be a list of at least one entry");
  }
  std::vector<SceneObject> copies;
  for (const auto& node : list) {
    YamlMap entry(node, file, "instance");
    SceneObject copy = object;
    copy.where = yaml_location(file, node);
    if (const auto offset = entry.vector3("offset")) copy.offset += *offset;
    copy.yaw_deg += entry.number("yaw").value_or(0.0);
    if (const auto size = entry.positive("size")) copy.size = size;
    copy.start_s += entry.number("start").value_or(0.0);
    entry.finish();
    // Only the first can be stood on: a name means one object.
    if (!copies.empty()) copy.name.clear();
    copies.push_back(copy);
  }
  return copies;
}

}  // namespace

MarkerId read_marker(YamlMap& map) {
  MarkerId marker;
  marker.dictionary = map.text("dictionary").value_or("4x4_50");
  const std::optional<int> id = map.integer("id");
  if (!id) map.fail("id", "a marker needs its 'id'");
  marker.id = *id;
  const auto dictionary = marker_dictionary(marker.dictionary);
  if (!dictionary) {
    map.fail("dictionary", fmt::format("'dictionary' must be one of {}",
                                       fmt::join(marker_dictionary_names(), ", ")));
  }
  const int size = dictionary->bytesList.rows;
  if (marker.id < 0 || marker.id >= size) {
    map.fail("id", "'id' must lie between 0 and " + std::to_string(size - 1));
  }
  return marker;
}

std::vector<SceneObject> read_object(const YAML::Node& node, const std::string& file,
                                     const fs::path& path) {
  YamlMap map(node, file, "object");
  SceneObject object;
  object.where = file + ":" + std::to_string(map.line());
  object.name = map.text("name").value_or("");
  if (map.has("poster")) {
    if (map.has("model")) map.fail("poster", "object with both 'model' and 'poster'");
    read_poster(map, path, object);
  } else {
    if (!map.text("model")) map.fail("model", "object without 'model' or 'poster'");
    object.model = find_file(map, "model", path);
    read_size(map, object);
  }
  read_place(map, object);
  object.yaw_deg = map.number("yaw").value_or(0.0);
  if (map.choice("face", {"camera", "keep"}).value_or("camera") == "keep")
    object.face = Face::kKeep;
  read_animation(map, object);
  std::vector<SceneObject> objects = read_instances(map, file, object);
  map.finish();
  return objects;
}

}  // namespace planecast::engine
