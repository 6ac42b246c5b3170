#include "render/gltf/animate.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "render/gltf/import.h"
#include "render/gltf/tangents.h"

namespace planecast::render {
namespace {

/// Value of a channel at a time: `width` numbers.
std::vector<float> sample_channel(const AnimationChannel& channel, float time_s) {
  const auto width = static_cast<std::size_t>(channel.width);
  const std::size_t keys = channel.times_s.size();
  const bool spline = channel.interpolation == Interpolation::kCubicSpline;
  const auto key = [&](std::size_t i, std::size_t part) {
    return &channel.values[(spline ? 3 * i + part : i) * width];
  };
  const auto next = std::upper_bound(channel.times_s.begin(), channel.times_s.end(), time_s);
  const auto after = static_cast<std::size_t>(next - channel.times_s.begin());
  if (after == 0 || after == keys || channel.interpolation == Interpolation::kStep) {
    const float* value = key(after == 0 ? 0 : after - 1, 1);
    return {value, value + width};
  }
  const std::size_t before = after - 1;
  const float span = channel.times_s[after] - channel.times_s[before];
  const float t = (time_s - channel.times_s[before]) / span;
  const float* a = key(before, 1);
  const float* b = key(after, 1);
  std::vector<float> out(width);
  if (spline) {
    const float* leaving = key(before, 2);
    const float* arriving = key(after, 0);
    const float t2 = t * t;
    const float t3 = t2 * t;
    for (std::size_t i = 0; i < width; ++i) {
      out[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span * (t3 - 2 * t2 + t) * leaving[i] +
               (-2 * t3 + 3 * t2) * b[i] + span * (t3 - t2) * arriving[i];
    }
  } else if (channel.path == ChannelPath::kRotation) {
    const glm::quat q =
        glm::slerp(glm::quat(a[3], a[0], a[1], a[2]), glm::quat(b[3], b[0], b[1], b[2]), t);
    out = {q.x, q.y, q.z, q.w};
  } else {
    for (std::size_t i = 0; i < width; ++i) out[i] = a[i] + t * (b[i] - a[i]);
  }
  return out;
}

void apply_channel(const AnimationChannel& channel, float time_s, NodeTransform& transform,
                   std::vector<float>& weights) {
  if (channel.width == 0) return;
  const std::vector<float> v = sample_channel(channel, time_s);
  switch (channel.path) {
    case ChannelPath::kTranslation:
      transform.translation = {v[0], v[1], v[2]};
      break;
    case ChannelPath::kScale:
      transform.scale = {v[0], v[1], v[2]};
      break;
    case ChannelPath::kRotation: {
      const glm::quat q(v[3], v[0], v[1], v[2]);
      if (glm::length(q) > 0.0F) transform.rotation = glm::normalize(q);
      break;
    }
    case ChannelPath::kWeights:
      weights = v;
      break;
  }
}

glm::mat4 matrix_of(const NodeTransform& transform) {
  const glm::mat4 translation = glm::translate(glm::mat4(1.0F), transform.translation);
  return glm::scale(translation * glm::mat4_cast(transform.rotation), transform.scale);
}

std::vector<float> rest_weights(const Model& model, const Node& node) {
  if (node.mesh < 0 || !node.weights.empty()) return node.weights;
  return model.meshes[static_cast<std::size_t>(node.mesh)].weights;
}

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return length > 1e-12F ? v / length : otherwise;
}

void add_targets(const Primitive& primitive, const std::vector<float>& weights,
                 std::vector<ShapeVertex>& shape) {
  for (std::size_t t = 0; t < std::min(weights.size(), primitive.targets.size()); ++t) {
    const MorphTarget& target = primitive.targets[t];
    const float weight = weights[t];
    if (weight == 0.0F) continue;
    for (std::size_t i = 0; i < target.positions.size(); ++i) {
      shape[i].position += weight * target.positions[i];
    }
    for (std::size_t i = 0; i < target.normals.size(); ++i) {
      shape[i].normal += weight * target.normals[i];
    }
    for (std::size_t i = 0; i < target.tangents.size(); ++i) {
      shape[i].tangent += glm::vec4(weight * target.tangents[i], 0.0F);
    }
  }
}

void skin_vertex(const glm::mat4& model_from_bind, ShapeVertex& vertex) {
  const glm::mat3 linear(model_from_bind);
  vertex.position = glm::vec3(model_from_bind * glm::vec4(vertex.position, 1.0F));
  // Cofactors: right for scaled joints too, and never singular.
  const glm::mat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                            glm::cross(linear[0], linear[1]));
  vertex.normal = unit_or(cofactors * vertex.normal, vertex.normal);
  vertex.tangent = glm::vec4(unit_or(linear * glm::vec3(vertex.tangent), glm::vec3(vertex.tangent)),
                             vertex.tangent.w);
}

}  // namespace

ModelPose evaluate_pose(const Model& model, int animation, float time_s) {
  std::vector<NodeTransform> local(model.nodes.size());
  ModelPose pose;
  pose.model_from_node.assign(model.nodes.size(), glm::mat4(1.0F));
  pose.morph_weights.resize(model.nodes.size());
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    local[i] = model.nodes[i].rest;
    pose.morph_weights[i] = rest_weights(model, model.nodes[i]);
  }
  std::vector<std::uint8_t> animated(model.nodes.size(), 0);
  if (animation >= 0 && static_cast<std::size_t>(animation) < model.animations.size()) {
    const Animation& chosen = model.animations[static_cast<std::size_t>(animation)];
    float time = std::isfinite(time_s) ? time_s : 0.0F;
    if (chosen.duration_s > 0.0F && (time < 0.0F || time > chosen.duration_s)) {
      time = std::fmod(time, chosen.duration_s);
      if (time < 0.0F) time += chosen.duration_s;
    }
    for (const AnimationChannel& channel : chosen.channels) {
      const auto node = static_cast<std::size_t>(channel.node);
      apply_channel(channel, time, local[node], pose.morph_weights[node]);
      if (channel.path != ChannelPath::kWeights) animated[node] = 1;
    }
  }
  for (const int index : model.order) {
    const auto i = static_cast<std::size_t>(index);
    const Node& node = model.nodes[i];
    const bool fixed = node.matrix.has_value() && animated[i] == 0;
    const glm::mat4 parent_from_node = fixed ? *node.matrix : matrix_of(local[i]);
    pose.model_from_node[i] =
        node.parent < 0
            ? parent_from_node
            : pose.model_from_node[static_cast<std::size_t>(node.parent)] * parent_from_node;
  }
  return pose;
}

std::vector<glm::mat4> joint_matrices(const Skin& skin, const ModelPose& pose) {
  std::vector<glm::mat4> matrices(skin.joints.size());
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    matrices[i] = pose.model_from_node[static_cast<std::size_t>(skin.joints[i])] *
                  skin.joint_from_skin_bind[i];
  }
  return matrices;
}

std::vector<ShapeVertex> deform(const Primitive& primitive, const std::vector<float>& weights,
                                const std::vector<glm::mat4>& joints) {
  std::vector<ShapeVertex> shape = primitive.shape;
  add_targets(primitive, weights, shape);
  if (primitive.flat_normals) set_flat_normals(shape);
  const bool skinned = !joints.empty() && !primitive.joints.empty();
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (skinned) {
      glm::mat4 blended(0.0F);
      for (std::size_t k = 0; k < 4; ++k) {
        blended += primitive.joint_weights[i][static_cast<int>(k)] * joints[primitive.joints[i][k]];
      }
      skin_vertex(blended, shape[i]);
    } else {
      shape[i].normal = unit_or(shape[i].normal, glm::vec3(0.0F, 0.0F, 1.0F));
    }
  }
  return shape;
}

bool deforms(const Primitive& primitive, const Node& node) {
  return !primitive.targets.empty() || (node.skin >= 0 && !primitive.joints.empty());
}

Box pose_bounds(const Model& model, const ModelPose& pose) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Box box{glm::vec3(kInfinity), glm::vec3(-kInfinity)};
  const auto add = [&box](const glm::mat4& matrix, const glm::vec3& position) {
    const glm::vec3 p = glm::vec3(matrix * glm::vec4(position, 1.0F));
    box.min = glm::min(box.min, p);
    box.max = glm::max(box.max, p);
  };
  for (const int index : model.order) {
    const auto i = static_cast<std::size_t>(index);
    const Node& node = model.nodes[i];
    if (node.mesh < 0) continue;
    for (const Primitive& primitive :
         model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      const bool skinned = node.skin >= 0 && !primitive.joints.empty();
      const glm::mat4 matrix = skinned ? glm::mat4(1.0F) : pose.model_from_node[i];
      if (!deforms(primitive, node)) {
        for (const ShapeVertex& vertex : primitive.shape) add(matrix, vertex.position);
        continue;
      }
      std::vector<glm::mat4> joints;
      if (skinned) joints = joint_matrices(model.skins[static_cast<std::size_t>(node.skin)], pose);
      for (const ShapeVertex& vertex : deform(primitive, pose.morph_weights[i], joints)) {
        add(matrix, vertex.position);
      }
    }
  }
  return box.min.x <= box.max.x ? box : Box{};
}

Bounds model_bounds(const Model& model) {
  const Box box = pose_bounds(model, evaluate_pose(model, -1, 0.0F));
  return {box.min, box.max};
}

std::vector<std::string> animation_names(const Model& model) {
  std::vector<std::string> names;
  for (const Animation& animation : model.animations) names.push_back(animation.name);
  return names;
}

float animation_duration_s(const Model& model, int animation) {
  const bool exists =
      animation >= 0 && static_cast<std::size_t>(animation) < model.animations.size();
  return exists ? model.animations[static_cast<std::size_t>(animation)].duration_s : 0.0F;
}

}  // namespace planecast::render
