#include "engine/scene/read_scale.h"

#include "engine/scene/read_object.h"

namespace planecast::engine {
namespace {

EdgeScale read_edge(YamlMap& map) {
  const auto frame = map.integer("frame");
  const auto from = map.vector2("from");
  const auto to = map.vector2("to");
  const auto length = map.positive("length");
  if (!frame || !from || !to || !length) {
    map.fail("frame", "'edge' needs 'frame', 'from', 'to' and 'length'");
  }
  return {*length, *frame, *from, *to};
}

HeightScale read_height(YamlMap& map) {
  const auto frame = map.integer("frame");
  const auto foot = map.vector2("foot");
  const auto top = map.vector2("top");
  const auto height = map.positive("height");
  if (!frame || !foot || !top || !height) {
    map.fail("frame", "'object' needs 'frame', 'foot', 'top' and 'height'");
  }
  return {*height, *frame, *foot, *top};
}

MarkerScale read_marker_scale(YamlMap& map) {
  MarkerScale scale;
  scale.marker = read_marker(map);
  const auto size = map.positive("size");
  if (!size) map.fail("size", "'marker' needs its 'size' in metres");
  scale.size_m = *size;
  return scale;
}

}  // namespace

std::optional<ScaleHint> read_scale(YamlMap& root, const std::string& file) {
  std::optional<YamlMap> map = root.map("scale");
  if (!map) return std::nullopt;
  ScaleHint hint;
  hint.where = file + ":" + std::to_string(root.line_of("scale"));
  if (std::optional<YamlMap> edge = map->map("edge")) {
    hint.rule = read_edge(*edge);
    edge->finish();
  } else if (std::optional<YamlMap> object = map->map("object")) {
    hint.rule = read_height(*object);
    object->finish();
  } else if (std::optional<YamlMap> marker = map->map("marker")) {
    hint.rule = read_marker_scale(*marker);
    marker->finish();
  } else if (const auto height = map->positive("camera_height")) {
    hint.rule = CameraHeightScale{*height, map->integer("frame")};
  } else if (const auto distance = map->positive("plane_distance")) {
    hint.rule = PlaneDistanceScale{*distance, map->integer("frame")};
  } else {
    map->finish();
    root.fail("scale",
              "'scale' needs 'plane_distance', 'edge', 'object', 'marker' or 'camera_height'");
  }
  map->finish();
  return hint;
}

}  // namespace planecast::engine
