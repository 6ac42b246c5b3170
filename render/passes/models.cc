#include "render/passes/models.h"

#include <algorithm>
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

GLenum draw_mode(Topology topology) {
  switch (topology) {
    case Topology::kPoints:
      return GL_POINTS;
    case Topology::kLines:
      return GL_LINES;
    case Topology::kTriangles:
      break;
  }
  return GL_TRIANGLES;
}

/// The full mesh and its coarser versions in one index buffer.
MeshBuffers upload_primitive(const Gl& gl, const Primitive& primitive) {
  std::vector<std::uint32_t> indices = primitive.indices;
  std::vector<IndexRange> levels = {{0, static_cast<GLsizei>(indices.size()), 0.0F}};
  for (const DetailLevel& level : primitive.details) {
    levels.push_back({indices.size(), static_cast<GLsizei>(level.indices.size()), level.error});
    indices.insert(indices.end(), level.indices.begin(), level.indices.end());
  }
  return upload_levels(gl, primitive.shape, primitive.surface, indices, std::move(levels));
}

bool finite(const glm::mat4& matrix) {
  float sum = 0.0F;
  for (int column = 0; column < 4; ++column) sum += glm::dot(matrix[column], glm::vec4(1.0F));
  return std::isfinite(sum);
}

}  // namespace

std::size_t DrawItem::level(float error_m) const {
  const glm::mat3 linear(world_from_shape);
  const float scale =
      std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2]), 1e-20F});
  std::size_t chosen = 0;
  while (chosen + 1 < levels->size() && (*levels)[chosen + 1].error * scale <= error_m) ++chosen;
  return chosen;
}

void DrawItem::draw(const Gl& gl, float error_m) const {
  const IndexRange& range = (*levels)[level(error_m)];
  gl.BindVertexArray(vertex_array);
  gl.DrawElements(mode, range.count, GL_UNSIGNED_INT,
                  reinterpret_cast<const void*>(range.first * sizeof(std::uint32_t)));
}

const std::vector<DrawItem>& ModelSet::pose(const std::vector<Instance>& instances) {
  const auto gone =
      std::erase_if(models_, [](const auto& item) { return item.second.model.expired(); });
  // Deformed shapes refer to meshes by address, and a new model may get the address of a gone one.
  if (gone > 0) deformed_.clear();
  items_.clear();
  lamps_.clear();
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
      primitives.push_back(upload_primitive(*gl_, primitive));
    }
  }
  return gpu;
}

void ModelSet::add_instance(const Instance& instance) {
  const Model& model = *instance.model;
  GpuModel& gpu = upload(instance.model);
  const ModelPose pose = evaluate_pose(model, instance.animation, instance.animation_time_s);
  add_lamps(model, instance.world_from_model, pose);
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
      item.mode = draw_mode(primitive.topology);
      item.unlit = primitive.unlit;
      item.levels = &mesh.levels;
      item.material = &model.materials[static_cast<std::size_t>(primitive.material)];
      item.model = &model;
      item.gpu = &gpu;
      item.primitive = &primitive;
      item.shape = &primitive.shape;
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

void ModelSet::add_lamps(const Model& model, const glm::mat4& world_from_model,
                         const ModelPose& pose) {
  constexpr float kInversePi = 0.31830989F;
  for (const ModelLight& light : model.lights) {
    if (lamps_.size() == kMostLamps) return;
    const glm::mat4 world_from_light =
        world_from_model * pose.model_from_node[static_cast<std::size_t>(light.node)];
    const glm::vec3 shines = -glm::vec3(world_from_light[2]);
    if (!finite(world_from_light) || glm::length(shines) < 1e-12F) continue;
    Lamp lamp;
    const glm::vec3 axis = glm::normalize(shines);
    const bool directional = light.kind == LightKind::kDirectional;
    lamp.position = directional ? glm::vec4(-axis, 0.0F) : world_from_light[3];
    lamp.intensity = glm::vec4(light.intensity * kInversePi, light.range);
    // A point light is a cone wider than everything.
    const bool spot = light.kind == LightKind::kSpot;
    lamp.axis = glm::vec4(axis, spot ? std::cos(light.outer_cone_rad) : -2.0F);
    lamp.inner_cosine = spot ? std::cos(light.inner_cone_rad) : -1.5F;
    lamps_.push_back(lamp);
  }
}

void ModelSet::add_deformed(DrawItem item, const MeshBuffers& mesh,
                            std::vector<ShapeVertex> shape) {
  if (deformed_used_ == deformed_.size()) deformed_.emplace_back();
  Deformed& slot = deformed_[deformed_used_++];
  if (!slot.shape) slot.shape = BufferHandle(*gl_);
  slot.vertices = std::move(shape);
  planecast::render::upload(*gl_, slot.shape, std::span<const ShapeVertex>(slot.vertices),
                            GL_STREAM_DRAW);
  if (slot.base != &mesh) {
    slot.vertex_array = make_deformed_array(*gl_, slot.shape, mesh);
    slot.base = &mesh;
  }
  item.vertex_array = slot.vertex_array.id();
  item.box = shape_box(slot.vertices);
  item.shape = &slot.vertices;
  item.shape_version = ++deformations_;
  items_.push_back(item);
}

TextureUse base_color_use(const DrawItem& item) {
  const int texture = item.material->base_color_map.texture;
  if (texture < 0) return TextureUse::kColor;
  const int image = item.model->textures[static_cast<std::size_t>(texture)].image;
  return better_encoded(item.model->images[static_cast<std::size_t>(image)]) ? TextureUse::kEncoded
                                                                             : TextureUse::kColor;
}

GLuint ModelSet::texture(const DrawItem& item, const TextureSlot& slot, TextureUse use) const {
  const auto known = item.gpu->textures.find({slot.texture, use});
  if (known != item.gpu->textures.end()) return known->second.id();
  const ModelTexture& texture = item.model->textures[static_cast<std::size_t>(slot.texture)];
  const TextureOptions options{use == TextureUse::kColor, texture.wrap_s, texture.wrap_t,
                               texture.min_filter, texture.mag_filter};
  const ImageU8& image = item.model->images[static_cast<std::size_t>(texture.image)];
  TextureHandle handle = use == TextureUse::kEncoded ? upload_encoded(*gl_, image, options)
                                                     : upload_image(*gl_, image, options);
  const GLuint id = handle.id();
  item.gpu->textures.emplace(std::make_pair(slot.texture, use), std::move(handle));
  return id;
}

const MipTexture& texture_in_memory(const DrawItem& item, const TextureSlot& slot, TextureUse use) {
  const auto [place, is_new] = item.gpu->textures_in_memory.try_emplace({slot.texture, use});
  if (is_new) {
    const ModelTexture& texture = item.model->textures[static_cast<std::size_t>(slot.texture)];
    MipTexture::Options options;
    options.wrap_s = texture.wrap_s;
    options.wrap_t = texture.wrap_t;
    options.min_filter = texture.min_filter;
    options.mag_filter = texture.mag_filter;
    options.colors = use != TextureUse::kNumbers;
    options.decode = use == TextureUse::kColor;
    place->second =
        MipTexture(item.model->images[static_cast<std::size_t>(texture.image)], options);
  }
  return place->second;
}

void ModelSet::clear() {
  items_.clear();
  lamps_.clear();
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
