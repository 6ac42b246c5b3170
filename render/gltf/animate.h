#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/gltf/model.h"

namespace planecast::render {

/// A model at one moment.
struct ModelPose {
  std::vector<glm::mat4> model_from_node;         ///< by node; those outside the scene are identity
  std::vector<std::vector<float>> morph_weights;  ///< by node
};

/// Rest pose for animation -1 or one that does not exist. Times beyond the duration are looped;
/// outside a channel's keys its first or last value holds. glTF 2.0, section 3.11 and appendix C.
ModelPose evaluate_pose(const Model& model, int animation, float time_s);

/// Model-from-bind for each joint of a skin: the mesh's own node does not count (3.7.3.3).
std::vector<glm::mat4> joint_matrices(const Skin& skin, const ModelPose& pose);

/// Morph targets, then skinning by `joints` (empty: none; the result stays in the mesh's frame).
/// Only for primitives that have either.
std::vector<ShapeVertex> deform(const Primitive& primitive, const std::vector<float>& weights,
                                const std::vector<glm::mat4>& joints);

/// Whether a primitive needs deform() at a node with or without a skin.
bool deforms(const Primitive& primitive, const Node& node);

/// Box of the posed vertices in model space.
Box pose_bounds(const Model& model, const ModelPose& pose);

}  // namespace planecast::render
