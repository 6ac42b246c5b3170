#include "engine/scene/write_scene_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "engine/output/atomic_file.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

/// The fewest digits that are read back exactly.
std::string number(double value) { return fmt::format("{}", value == 0.0 ? 0.0 : value); }

template <typename Vector>
YAML::Node list(const Vector& values) {
  YAML::Node node(YAML::NodeType::Sequence);
  for (const double value : values) node.push_back(number(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node place_node(const PixelPlace& place) {
  YAML::Node node;
  node["frame"] = place.frame;
  node["pixel"] = list(place.pixel);
  return node;
}

YAML::Node place_node(const PlanePlace& place) {
  YAML::Node node;
  node["plane"] = place.plane;
  node["at"] = list(place.at);
  return node;
}

YAML::Node place_node(const PointPlace& place) {
  YAML::Node node;
  node["position"] = list(place.position);
  if (place.normal.norm() > 0.0) node["normal"] = list(place.normal);
  return node;
}

YAML::Node marker_node(const MarkerId& marker) {
  YAML::Node node;
  node["dictionary"] = marker.dictionary;
  node["id"] = marker.id;
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node place_node(const MarkerPlace& place) {
  YAML::Node node;
  node["marker"] = marker_node(place.marker);
  return node;
}

YAML::Node place_node(const ObjectPlace& place) {
  YAML::Node node;
  node["on"] = place.object;
  return node;
}

std::string relative_path(const fs::path& file, const fs::path& folder) {
  return fs::absolute(file).lexically_proximate(fs::absolute(folder)).string();
}

YAML::Node poster_node(const SceneObject& object, const fs::path& folder) {
  YAML::Node node;
  node[object.poster->video ? "video" : "image"] = relative_path(object.poster->file, folder);
  if (object.size) node["width"] = number(*object.size);
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node size_node(const SceneObject& object) {
  if (object.unit == LengthUnit::kBest) return YAML::Node(number(*object.size));
  YAML::Node node;
  node[object.unit == LengthUnit::kMetres ? "metres" : "relative"] = number(*object.size);
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node object_node(const SceneObject& object, const fs::path& folder) {
  YAML::Node node;
  if (!object.name.empty()) node["name"] = object.name;
  if (object.poster) {
    node["poster"] = poster_node(object, folder);
  } else {
    node["model"] = relative_path(object.model, folder);
  }
  node["place"] = std::visit([](const auto& place) { return place_node(place); }, object.place);
  if (!object.offset.isZero()) node["place"]["offset"] = list(object.offset);
  node["place"].SetStyle(YAML::EmitterStyle::Flow);
  if (object.size && !object.poster) node["size"] = size_node(object);
  if (object.yaw_deg != 0.0) node["yaw"] = number(object.yaw_deg);
  if (object.face == Face::kKeep) node["face"] = "keep";
  if (object.animation_index) {
    node["animation"] = *object.animation_index;
  } else if (!object.animation.empty()) {
    node["animation"] = object.animation;
  }
  if (!object.loop) node["loop"] = false;
  if (object.start_s != 0.0) node["start"] = number(object.start_s);
  return node;
}

/// The switches that are off; not a map where there are none.
YAML::Node look_node(const Look& look) {
  YAML::Node node;
  if (!look.grain) node["grain"] = false;
  if (!look.blur) node["blur"] = false;
  if (!look.exposure) node["exposure"] = false;
  if (!look.lens) node["lens"] = false;
  if (!look.clean_edges) node["clean_edges"] = false;
  return node;
}

YAML::Node radiance_node(const Eigen::Vector3d& radiance) {
  YAML::Node node;
  node["color"] = list(radiance);
  node["intensity"] = 1;
  return node;
}

YAML::Node light_node(const FixedLight& light) {
  YAML::Node node;
  node["sun"] = radiance_node(light.sun_radiance);
  node["sun"]["direction"] = list(light.sun_direction);
  node["sky"] = radiance_node(light.sky_radiance);
  return node;
}

YAML::Node scale_node(const PlaneDistanceScale& rule) {
  YAML::Node node;
  node["plane_distance"] = number(rule.distance_m);
  if (rule.frame) node["frame"] = *rule.frame;
  return node;
}

YAML::Node scale_node(const EdgeScale& rule) {
  YAML::Node edge;
  edge["frame"] = rule.frame;
  edge["from"] = list(rule.from);
  edge["to"] = list(rule.to);
  edge["length"] = number(rule.length_m);
  YAML::Node node;
  node["edge"] = edge;
  return node;
}

YAML::Node scale_node(const HeightScale& rule) {
  YAML::Node object;
  object["frame"] = rule.frame;
  object["foot"] = list(rule.foot);
  object["top"] = list(rule.top);
  object["height"] = number(rule.height_m);
  YAML::Node node;
  node["object"] = object;
  return node;
}

YAML::Node scale_node(const MarkerScale& rule) {
  YAML::Node node;
  node["marker"] = marker_node(rule.marker);
  node["marker"]["size"] = number(rule.size_m);
  return node;
}

YAML::Node scale_node(const CameraHeightScale& rule) {
  YAML::Node node;
  node["camera_height"] = number(rule.height_m);
  if (rule.frame) node["frame"] = *rule.frame;
  return node;
}

const char* occlusion_word(Occlusion occlusion) {
  switch (occlusion) {
    case Occlusion::kNone:
      return "none";
    case Occlusion::kDepth:
      return "depth";
    case Occlusion::kBoth:
      return "both";
    case Occlusion::kPlanes:
      break;
  }
  return "planes";
}

}  // namespace

std::string scene_yaml(const SceneFile& scene, const fs::path& folder) {
  YAML::Node root;
  if (scene.light) root["light"] = light_node(*scene.light);
  if (!scene.shadows) root["shadows"] = false;
  if (scene.occlusion != Occlusion::kPlanes) root["occlusion"] = occlusion_word(scene.occlusion);
  if (const YAML::Node look = look_node(scene.look); look.IsMap()) root["look"] = look;
  if (!scene.keep_apart) root["keep_apart"] = false;
  if (scene.ease_frames != SceneFile{}.ease_frames) root["ease"] = scene.ease_frames;
  root["objects"] = YAML::Node(YAML::NodeType::Sequence);
  for (const SceneObject& object : scene.objects) {
    root["objects"].push_back(object_node(object, folder));
  }
  if (scene.scale) {
    root["scale"] =
        std::visit([](const auto& rule) { return scale_node(rule); }, scene.scale->rule);
  }
  YAML::Emitter emitter;
  emitter << root;
  return std::string(emitter.c_str()) + "\n";
}

void write_scene_file(const SceneFile& scene, const fs::path& path) {
  write_file(path, scene_yaml(scene, path.parent_path().empty() ? "." : path.parent_path()));
}

}  // namespace planecast::engine
