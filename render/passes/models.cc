#include "render/passes/models.h"

#include <cmath>

#include "render/gl/image_texture.h"
#include "render/gltf/animate.h"
#include "render/passes/content_hash.h"
#include "render/passes/view.h"

namespace planecast::render {
namespace {

Box shape_box(const std::vector<ShapeVertex>& shape) {
  Box box{shape.front().position, shape.front().position};
  for (const ShapeVertex& vertex : shape) {
    box.min = glm::min(box.min, vertex.position);
    box.max = glm::max(box.max, vertex.position);
  }
  return box;
}

bool finite(const glm::mat4& matrix) {
  float sum = 0.0F;
  for (int column = 0; column < 4; ++column) sum += glm::dot(matrix[column], glm::vec4(1.0F));
  return std::isfinite(sum);
}

}  // namespace

void DrawItem::draw(const Gl& gl) const {
  gl.BindVertexArray(vertex_array);
  gl.DrawElements(GL_TRIANGLES, index_count, GL_UNSIGNED_INT, nullptr);
}

const std::vector<DrawItem>& ModelSet::pose(const std::vector<Instance>& instances) {
  const auto gone =
      std::erase_if(models_, [](const auto& item) { return item.second.model.expired(); });
  // Deformed shapes refer to meshes by address, and a new model may get the address of a gone one.
  if (gone > 0) deformed_.clear();
  items_.clear();
  deformed_used_ = 0;
  ContentHash signature;
  for (const Instance& instance : instances) {
    if (instance.model == nullptr || !finite(instance.world_from_model)) continue;
    signature.add(upload(instance.model).serial);
    signature.add(instance.world_from_model);
    signature.add(instance.animation);
    signature.add(instance.animation_time_s);
    add_instance(instance);
  }
  signature_ = signature.value();
  return items_;
}

GpuModel& ModelSet::upload(const std::shared_ptr<const Model>& model) {
  const auto [place, is_new] = models_.try_emplace(model.get());
  GpuModel& gpu = place->second;
  if (!is_new) return gpu;
  gpu.model = model;
  gpu.serial = ++uploads_;
  for (const Mesh& mesh : model->meshes) {
    auto& primitives = gpu.meshes.emplace_back();
    for (const Primitive& primitive : mesh.primitives) {
      primitives.push_back(
          upload_mesh(*gl_, primitive.shape, primitive.surface, primitive.indices));
    }
  }
  return gpu;
}

void ModelSet::add_instance(const Instance& instance) {
  const Model& model = *instance.model;
  GpuModel& gpu = upload(instance.model);
  const ModelPose pose = evaluate_pose(model, instance.animation, instance.animation_time_s);
  for (const int index : model.order) {
    const auto node_index = static_cast<std::size_t>(index);
    const Node& node = model.nodes[node_index];
    if (node.mesh < 0) continue;
    const auto mesh_index = static_cast<std::size_t>(node.mesh);
    std::vector<glm::mat4> joints;
    if (node.skin >= 0) {
      joints = joint_matrices(model.skins[static_cast<std::size_t>(node.skin)], pose);
    }
    const auto& primitives = model.meshes[mesh_index].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const Primitive& primitive = primitives[p];
      const MeshBuffers& mesh = gpu.meshes[mesh_index][p];
      const bool skinned = !joints.empty() && !primitive.joints.empty();
      DrawItem item;
      item.index_count = mesh.index_count;
      item.material = &model.materials[static_cast<std::size_t>(primitive.material)];
      item.model = &model;
      item.gpu = &gpu;
      item.world_from_shape = skinned
                                  ? instance.world_from_model
                                  : instance.world_from_model * pose.model_from_node[node_index];
      if (deforms(primitive, node)) {
        add_deformed(item, mesh, deform(primitive, pose.morph_weights[node_index], joints));
      } else {
        item.vertex_array = mesh.vertex_array.id();
        item.box = primitive.box;
        items_.push_back(item);
      }
    }
  }
}

void ModelSet::add_deformed(DrawItem item, const MeshBuffers& mesh,
                            const std::vector<ShapeVertex>& shape) {
  if (deformed_used_ == deformed_.size()) deformed_.emplace_back();
  Deformed& slot = deformed_[deformed_used_++];
  if (!slot.shape) slot.shape = BufferHandle(*gl_);
  planecast::render::upload(*gl_, slot.shape, std::span<const ShapeVertex>(shape), GL_STREAM_DRAW);
  if (slot.base != &mesh) {
    slot.vertex_array = make_deformed_array(*gl_, slot.shape, mesh);
    slot.base = &mesh;
  }
  item.vertex_array = slot.vertex_array.id();
  item.box = shape_box(shape);
  items_.push_back(item);
}

GLuint ModelSet::texture(const DrawItem& item, const TextureSlot& slot, bool srgb) const {
  const auto known = item.gpu->textures.find({slot.texture, srgb});
  if (known != item.gpu->textures.end()) return known->second.id();
  const ModelTexture& texture = item.model->textures[static_cast<std::size_t>(slot.texture)];
  const TextureOptions options{srgb, texture.wrap_s, texture.wrap_t, texture.min_filter,
                               texture.mag_filter};
  TextureHandle handle =
      upload_image(*gl_, item.model->images[static_cast<std::size_t>(texture.image)], options);
  const GLuint id = handle.id();
  item.gpu->textures.emplace(std::make_pair(slot.texture, srgb), std::move(handle));
  return id;
}

void ModelSet::clear() {
  items_.clear();
  deformed_.clear();
  models_.clear();
}

std::vector<glm::vec3> world_box_points(const std::vector<DrawItem>& items) {
  std::vector<glm::vec3> points;
  for (const DrawItem& item : items) {
    const auto corners = box_corners(item.box, item.world_from_shape);
    points.insert(points.end(), corners.begin(), corners.end());
  }
  return points;
}

}  // namespace planecast::render
