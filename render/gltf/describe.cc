#include <cstdio>

#include "render/gltf/import.h"
#include "render/gltf/model.h"

namespace planecast::render {
namespace {

std::string quoted(const std::string& name) { return name.empty() ? "" : " '" + name + "'"; }

std::string seconds(float value) {
  char text[32];
  std::snprintf(text, sizeof(text), ", %.2f s", static_cast<double>(value));
  return text;
}

/// Triangles, lines and points of the scene, each mesh as often as a node shows it.
std::string counts_of(const Model& model) {
  std::size_t counts[3] = {0, 0, 0};
  for (const int index : model.order) {
    const int mesh = model.nodes[static_cast<std::size_t>(index)].mesh;
    if (mesh < 0) continue;
    for (const Primitive& primitive : model.meshes[static_cast<std::size_t>(mesh)].primitives) {
      const auto topology = static_cast<std::size_t>(primitive.topology);
      counts[topology] += primitive.indices.size() / (3 - topology);
    }
  }
  return std::to_string(counts[0]) + " triangles, " + std::to_string(counts[1]) + " lines, " +
         std::to_string(counts[2]) + " points";
}

std::string camera_line(const ModelCamera& camera) {
  char text[96];
  if (camera.perspective) {
    constexpr double kDegrees = 57.29577951308232;
    std::snprintf(text, sizeof(text), ": perspective, %.1f degrees high",
                  static_cast<double>(camera.y_fov_rad) * kDegrees);
  } else {
    std::snprintf(text, sizeof(text), ": orthographic, %.4g m high",
                  2.0 * static_cast<double>(camera.half_height));
  }
  return quoted(camera.name) + text;
}

const char* name_of(LightKind kind) {
  switch (kind) {
    case LightKind::kDirectional:
      return "directional";
    case LightKind::kSpot:
      return "spot";
    case LightKind::kPoint:
      break;
  }
  return "point";
}

}  // namespace

std::vector<std::string> describe_model(const Model& model) {
  std::vector<std::string> lines;
  const auto numbered = [&lines](const char* what, std::size_t i, const std::string& rest) {
    lines.push_back(std::string(what) + " " + std::to_string(i) + rest);
  };
  lines.push_back(counts_of(model));
  lines.push_back(std::to_string(model.meshes.size()) + " meshes, " +
                  std::to_string(model.nodes.size()) + " nodes, " +
                  std::to_string(model.materials.size() - 1) + " materials, " +
                  std::to_string(model.images.size()) + " images, " +
                  std::to_string(model.skins.size()) + " skins");
  for (std::size_t i = 0; i < model.scene_names.size(); ++i) {
    numbered("scene", i, quoted(model.scene_names[i]));
  }
  for (std::size_t i = 0; i < model.cameras.size(); ++i) {
    numbered("camera", i, camera_line(model.cameras[i]));
  }
  for (std::size_t i = 0; i < model.lights.size(); ++i) {
    numbered("light", i, std::string(": ") + name_of(model.lights[i].kind));
  }
  for (std::size_t i = 0; i < model.variant_names.size(); ++i) {
    numbered("variant", i, quoted(model.variant_names[i]));
  }
  for (std::size_t i = 0; i < model.animations.size(); ++i) {
    const Animation& animation = model.animations[i];
    numbered("animation", i, quoted(animation.name) + seconds(animation.duration_s));
  }
  return lines;
}

}  // namespace planecast::render
