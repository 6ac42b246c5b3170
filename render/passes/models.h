#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "render/gl/mesh_buffers.h"
#include "render/gl/program.h"
#include "render/gltf/animate.h"
#include "render/gltf/model.h"
#include "render/scene.h"
#include "render/software/mip_texture.h"

namespace planecast::render {

/// What a texture's bytes mean.
enum class TextureUse {
  kNumbers,  ///< as they are
  kColor,    ///< sRGB, decoded when sampled
  kEncoded,  ///< sRGB, decoded by the shader: see better_encoded()
};

/// A glTF model on the GPU. Textures follow on first use, since how one is decoded depends on its
/// use.
struct GpuModel {
  std::weak_ptr<const Model> model;
  std::uint64_t serial = 0;  ///< of the upload: an address may come back with another model
  std::vector<std::vector<MeshBuffers>> meshes;  ///< by mesh and primitive
  std::map<std::pair<int, TextureUse>, TextureHandle> textures;
  std::map<std::pair<int, TextureUse>, MipTexture> textures_in_memory;
};

/// One primitive of one instance, posed, ready for any pass.
struct DrawItem {
  GLuint vertex_array = 0;
  GLenum mode = GL_TRIANGLES;
  bool unlit = false;
  const std::vector<IndexRange>* levels = nullptr;
  const Material* material = nullptr;
  const Model* model = nullptr;
  GpuModel* gpu = nullptr;
  const Primitive* primitive = nullptr;
  const std::vector<ShapeVertex>* shape = nullptr;  ///< as posed
  std::uint64_t shape_version = 0;                  ///< differs between deformed shapes
  glm::mat4 world_from_shape = glm::mat4(1.0F);
  Box box;  ///< of the shape, in its own frame

  /// The coarsest level that is off by no more than `error_m` in the world; 0 is the full mesh.
  std::size_t level(float error_m) const;
  void draw(const Gl& gl, float error_m) const;
};

/// A light of a posed model in the world; see lamps.glsl.
struct Lamp {
  glm::vec4 position{};   ///< w = 1: a place; 0: the direction towards the light
  glm::vec4 intensity{};  ///< linear RGB / pi; a = range, 0 unlimited
  glm::vec4 axis{};       ///< direction it shines; w = cosine of the outer cone
  float inner_cosine = 0.0F;
};
inline constexpr std::size_t kMostLamps = 8;

/// Uploads models once, poses instances, deforms what is skinned or morphed.
class ModelSet {
 public:
  explicit ModelSet(const Gl& gl) : gl_(&gl) {}

  /// The items are valid until the next call. Instances without a model or
  /// with a pose that is not a number are passed over.
  const std::vector<DrawItem>& pose(const std::vector<Instance>& instances);
  /// The lights of the posed models, at most kMostLamps.
  const std::vector<Lamp>& lamps() const { return lamps_; }
  /// The texture of a slot that has one.
  GLuint texture(const DrawItem& item, const TextureSlot& slot, TextureUse use) const;
  /// Changes when what pose() was last given does.
  std::uint64_t signature() const { return signature_; }
  void clear();

 private:
  /// A deformed shape; kept for the item at the same place of the next frame.
  struct Deformed {
    const MeshBuffers* base = nullptr;
    std::vector<ShapeVertex> vertices;
    BufferHandle shape;
    VertexArrayHandle vertex_array;
  };

  GpuModel& upload(const std::shared_ptr<const Model>& model);
  void add_instance(const Instance& instance);
  void add_lamps(const Model& model, const glm::mat4& world_from_model, const ModelPose& pose);
  void add_deformed(DrawItem item, const MeshBuffers& mesh, std::vector<ShapeVertex> shape);

  const Gl* gl_;
  std::map<const Model*, GpuModel> models_;
  std::deque<Deformed> deformed_;  ///< items point into it
  std::size_t deformed_used_ = 0;
  std::vector<DrawItem> items_;
  std::vector<Lamp> lamps_;
  std::uint64_t uploads_ = 0;
  std::uint64_t deformations_ = 0;
  std::uint64_t signature_ = 0;
};

/// How the base colour of an item is kept.
TextureUse base_color_use(const DrawItem& item);

/// The texture of a slot that has one, for the processor; made on first use.
const MipTexture& texture_in_memory(const DrawItem& item, const TextureSlot& slot, TextureUse use);

/// Corners of the items' boxes in the world.
std::vector<glm::vec3> world_box_points(const std::vector<DrawItem>& items);

}  // namespace planecast::render
