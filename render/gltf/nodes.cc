#include "render/gltf/nodes.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <utility>

#include "render/gltf/accessors.h"

namespace planecast::render {
namespace {

void check_index(int index, std::size_t size, const char* what) {
  if (index >= static_cast<int>(size) || index < 0) {
    throw ImportError(std::string(what) + " " + std::to_string(index) + " does not exist");
  }
}

Node convert_node(const tinygltf::Node& from, const Model& model, std::size_t skins) {
  Node node;
  node.name = from.name;
  if (from.mesh >= 0) check_index(from.mesh, model.meshes.size(), "mesh");
  if (from.skin >= 0) check_index(from.skin, skins, "skin");
  node.mesh = from.mesh;
  node.skin = from.skin;
  if (from.matrix.size() == 16) {
    node.matrix = glm::mat4(glm::make_mat4(from.matrix.data()));
  }
  if (from.translation.size() == 3) node.rest.translation = glm::make_vec3(from.translation.data());
  if (from.scale.size() == 3) node.rest.scale = glm::make_vec3(from.scale.data());
  if (from.rotation.size() == 4) {
    const auto& q = from.rotation;
    const glm::quat rotation(static_cast<float>(q[3]), static_cast<float>(q[0]),
                             static_cast<float>(q[1]), static_cast<float>(q[2]));
    if (glm::length(rotation) > 0.0F) node.rest.rotation = glm::normalize(rotation);
  }
  node.weights.assign(from.weights.begin(), from.weights.end());
  return node;
}

void link_children(const tinygltf::Model& file, Model& model) {
  for (std::size_t parent = 0; parent < file.nodes.size(); ++parent) {
    for (const int child : file.nodes[parent].children) {
      check_index(child, model.nodes.size(), "node");
      Node& node = model.nodes[static_cast<std::size_t>(child)];
      if (node.parent >= 0) throw ImportError("a node has two parents");
      node.parent = static_cast<int>(parent);
    }
  }
}

/// With one parent a node, a cycle shows as a way up that comes back to itself. Each node is passed
/// once: the way up from one that is known to end is not gone again.
void check_no_cycles(const Model& model) {
  std::vector<int> passed_from(model.nodes.size(), -1);
  for (int start = 0; start < static_cast<int>(model.nodes.size()); ++start) {
    for (int up = start; up >= 0; up = model.nodes[static_cast<std::size_t>(up)].parent) {
      int& from = passed_from[static_cast<std::size_t>(up)];
      if (from == start) throw ImportError("the nodes form a cycle");
      if (from >= 0) break;
      from = start;
    }
  }
}

/// Without scenes everything that has no parent is drawn.
std::vector<int> scene_roots(const tinygltf::Model& file, int wanted, const Model& model) {
  if (file.scenes.empty()) {
    std::vector<int> roots;
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
      if (model.nodes[i].parent < 0) roots.push_back(static_cast<int>(i));
    }
    return roots;
  }
  const int standard = file.defaultScene < 0 ? 0 : file.defaultScene;
  const int scene = wanted < 0 ? standard : wanted;
  check_index(scene, file.scenes.size(), "scene");
  return file.scenes[static_cast<std::size_t>(scene)].nodes;
}

/// One attribute of EXT_mesh_gpu_instancing; empty where the node has none.
std::vector<float> instance_values(const tinygltf::Model& file, const tinygltf::Value& attributes,
                                   const char* name, int components) {
  if (!attributes.Has(name) || !attributes.Get(name).IsInt()) return {};
  return AccessorReader(file).floats(attributes.Get(name).GetNumberAsInt(), components);
}

/// Each is one more draw call for each primitive of the mesh.
constexpr std::size_t kMostInstances = 20000;

void add_instances_of(const tinygltf::Model& file, int index, Model& model) {
  const auto& extensions = file.nodes[static_cast<std::size_t>(index)].extensions;
  const auto found = extensions.find("EXT_mesh_gpu_instancing");
  if (found == extensions.end() || !found->second.Has("attributes")) return;
  const auto& attributes = found->second.Get("attributes");
  const auto translations = instance_values(file, attributes, "TRANSLATION", 3);
  const auto rotations = instance_values(file, attributes, "ROTATION", 4);
  const auto scales = instance_values(file, attributes, "SCALE", 3);
  const std::size_t count =
      std::max({translations.size() / 3, rotations.size() / 4, scales.size() / 3});
  if (model.nodes.size() + count > file.nodes.size() + kMostInstances) {
    throw ImportError("has more than " + std::to_string(kMostInstances) + " instances");
  }
  const int mesh = std::exchange(model.nodes[static_cast<std::size_t>(index)].mesh, -1);
  if (mesh < 0) return;
  for (std::size_t i = 0; i < count; ++i) {
    Node node;
    node.parent = index;
    node.mesh = mesh;
    if (3 * i + 2 < translations.size()) {
      node.rest.translation = glm::make_vec3(&translations[3 * i]);
    }
    if (3 * i + 2 < scales.size()) node.rest.scale = glm::make_vec3(&scales[3 * i]);
    if (4 * i + 3 < rotations.size()) {
      const float* q = &rotations[4 * i];
      const glm::quat rotation(q[3], q[0], q[1], q[2]);
      if (glm::length(rotation) > 0.0F) node.rest.rotation = glm::normalize(rotation);
    }
    model.order.push_back(static_cast<int>(model.nodes.size()));
    model.nodes.push_back(std::move(node));
  }
}

void add_instances(const tinygltf::Model& file, Model& model) {
  const std::vector<int> order = model.order;
  for (const int index : order) add_instances_of(file, index, model);
}

ChannelPath channel_path(const std::string& name) {
  if (name == "translation") return ChannelPath::kTranslation;
  if (name == "rotation") return ChannelPath::kRotation;
  if (name == "scale") return ChannelPath::kScale;
  if (name == "weights") return ChannelPath::kWeights;
  throw ImportError("an animation moves the unknown property " + name);
}

std::size_t target_count(const Model& model, const Node& node) {
  if (node.mesh < 0) return 0;
  std::size_t count = 0;
  for (const Primitive& primitive : model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
    count = std::max(count, primitive.targets.size());
  }
  return count;
}

AnimationChannel convert_channel(const tinygltf::Model& file, const tinygltf::Animation& animation,
                                 const tinygltf::AnimationChannel& from, const Model& model) {
  check_index(from.sampler, animation.samplers.size(), "animation sampler");
  check_index(from.target_node, model.nodes.size(), "node");
  const auto& sampler = animation.samplers[static_cast<std::size_t>(from.sampler)];
  const AccessorReader reader(file);
  AnimationChannel channel;
  channel.node = from.target_node;
  channel.path = channel_path(from.target_path);
  if (sampler.interpolation == "STEP") channel.interpolation = Interpolation::kStep;
  if (sampler.interpolation == "CUBICSPLINE") channel.interpolation = Interpolation::kCubicSpline;
  channel.times_s = reader.floats(sampler.input, 1);
  for (std::size_t i = 0; i < channel.times_s.size(); ++i) {
    const bool grows = i == 0 || channel.times_s[i] >= channel.times_s[i - 1];
    if (!std::isfinite(channel.times_s[i]) || !grows) {
      throw ImportError("the times of an animation do not increase");
    }
  }
  const Node& node = model.nodes[static_cast<std::size_t>(channel.node)];
  if (channel.path == ChannelPath::kWeights) {
    channel.width = static_cast<int>(target_count(model, node));
  } else if (channel.path == ChannelPath::kRotation) {
    channel.width = 4;
  }
  const int components = channel.path == ChannelPath::kWeights ? 1 : channel.width;
  channel.values = reader.floats(sampler.output, components);
  const std::size_t parts = channel.interpolation == Interpolation::kCubicSpline ? 3 : 1;
  if (channel.values.size() !=
      channel.times_s.size() * parts * static_cast<std::size_t>(channel.width)) {
    throw ImportError("an animation has a wrong number of values");
  }
  return channel;
}

}  // namespace

void import_nodes(const tinygltf::Model& file, int scene, Model& model) {
  for (const auto& node : file.nodes) {
    model.nodes.push_back(convert_node(node, model, file.skins.size()));
  }
  link_children(file, model);
  check_no_cycles(model);

  std::vector<std::uint8_t> seen(model.nodes.size(), 0);
  std::vector<int> waiting = scene_roots(file, scene, model);
  std::reverse(waiting.begin(), waiting.end());
  while (!waiting.empty()) {
    const int index = waiting.back();
    waiting.pop_back();
    check_index(index, model.nodes.size(), "node");
    if (std::exchange(seen[static_cast<std::size_t>(index)], 1) != 0) continue;
    model.order.push_back(index);
    const auto& children = file.nodes[static_cast<std::size_t>(index)].children;
    waiting.insert(waiting.end(), children.rbegin(), children.rend());
  }
  for (const auto& named : file.scenes) model.scene_names.push_back(named.name);
  add_instances(file, model);
}

void import_skins(const tinygltf::Model& file, Model& model) {
  const AccessorReader reader(file);
  for (const auto& from : file.skins) {
    Skin skin;
    skin.joints = from.joints;
    for (const int joint : skin.joints) check_index(joint, model.nodes.size(), "joint");
    if (skin.joints.empty()) throw ImportError("a skin has no joints");
    skin.joint_from_skin_bind.assign(skin.joints.size(), glm::mat4(1.0F));
    if (from.inverseBindMatrices >= 0) {
      const auto values = reader.floats(from.inverseBindMatrices, 16);
      if (values.size() / 16 < skin.joints.size()) {
        throw ImportError("a skin has too few inverse bind matrices");
      }
      for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        skin.joint_from_skin_bind[i] = glm::make_mat4(&values[16 * i]);
      }
    }
    model.skins.push_back(std::move(skin));
  }
}

void import_animations(const tinygltf::Model& file, Model& model) {
  for (const auto& from : file.animations) {
    Animation animation;
    animation.name = from.name;
    for (const auto& channel : from.channels) {
      if (channel.target_node < 0) continue;
      animation.channels.push_back(convert_channel(file, from, channel, model));
      animation.duration_s =
          std::max(animation.duration_s, animation.channels.back().times_s.back());
    }
    model.animations.push_back(std::move(animation));
  }
}

namespace {

ModelCamera convert_camera(const tinygltf::Camera& from, int node) {
  ModelCamera camera;
  camera.name = from.name;
  camera.node = node;
  camera.perspective = from.type != "orthographic";
  if (camera.perspective) {
    camera.y_fov_rad = static_cast<float>(from.perspective.yfov);
    camera.aspect = static_cast<float>(from.perspective.aspectRatio);
  } else {
    camera.half_height = std::abs(static_cast<float>(from.orthographic.ymag));
    camera.aspect = std::abs(static_cast<float>(from.orthographic.xmag)) / camera.half_height;
  }
  const bool usable = camera.perspective ? camera.y_fov_rad > 0.0F && camera.y_fov_rad < 3.1F
                                         : camera.half_height > 0.0F;
  if (!usable) throw ImportError("a camera has a wrong field of view");
  if (!std::isfinite(camera.aspect) || camera.aspect < 0.0F) camera.aspect = 0.0F;
  return camera;
}

ModelLight convert_light(const tinygltf::Light& from, int node) {
  ModelLight light;
  light.node = node;
  if (from.type == "directional") light.kind = LightKind::kDirectional;
  if (from.type == "spot") light.kind = LightKind::kSpot;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, from.color.size()); ++i) {
    light.intensity[static_cast<int>(i)] = static_cast<float>(from.color[i]);
  }
  light.intensity *= static_cast<float>(from.intensity);
  light.range = static_cast<float>(from.range);
  light.inner_cone_rad = static_cast<float>(from.spot.innerConeAngle);
  light.outer_cone_rad = static_cast<float>(from.spot.outerConeAngle);
  return light;
}

/// Index of the light at a node, -1: none.
int light_of(const tinygltf::Node& node) {
  const auto found = node.extensions.find("KHR_lights_punctual");
  if (found == node.extensions.end() || !found->second.Has("light") ||
      !found->second.Get("light").IsInt()) {
    return -1;
  }
  return found->second.Get("light").GetNumberAsInt();
}

}  // namespace

void import_cameras_and_lights(const tinygltf::Model& file, Model& model) {
  for (const int index : model.order) {
    if (static_cast<std::size_t>(index) >= file.nodes.size()) continue;  // of an instance
    const auto& node = file.nodes[static_cast<std::size_t>(index)];
    if (node.camera >= 0) {
      check_index(node.camera, file.cameras.size(), "camera");
      model.cameras.push_back(
          convert_camera(file.cameras[static_cast<std::size_t>(node.camera)], index));
    }
    if (const int light = light_of(node); light >= 0) {
      check_index(light, file.lights.size(), "light");
      model.lights.push_back(convert_light(file.lights[static_cast<std::size_t>(light)], index));
    }
  }
}

}  // namespace planecast::render
