#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "render/gl/mesh_buffers.h"
#include "render/gl/program.h"
#include "render/gltf/model.h"
#include "render/scene.h"

namespace planecast::render {

/// A glTF model on the GPU. Textures follow on first use, since how one is decoded depends on its
/// use.
struct GpuModel {
  std::weak_ptr<const Model> model;
  std::uint64_t serial = 0;  ///< of the upload: an address may come back with another model
  std::vector<std::vector<MeshBuffers>> meshes;            ///< by mesh and primitive
  std::map<std::pair<int, bool>, TextureHandle> textures;  ///< by texture and whether it is sRGB
};

/// One primitive of one instance, posed, ready for any pass.
struct DrawItem {
  GLuint vertex_array = 0;
  GLsizei index_count = 0;
  const Material* material = nullptr;
  const Model* model = nullptr;
  GpuModel* gpu = nullptr;
  glm::mat4 world_from_shape = glm::mat4(1.0F);
  Box box;  ///< of the shape, in its own frame

  void draw(const Gl& gl) const;
};

/// Uploads models once, poses instances, deforms what is skinned or morphed.
class ModelSet {
 public:
  explicit ModelSet(const Gl& gl) : gl_(&gl) {}

  /// The items are valid until the next call. Instances without a model or
  /// with a pose that is not a number are passed over.
  const std::vector<DrawItem>& pose(const std::vector<Instance>& instances);
  /// The texture of a slot that has one.
  GLuint texture(const DrawItem& item, const TextureSlot& slot, bool srgb) const;
  /// Changes when what pose() was last given does.
  std::uint64_t signature() const { return signature_; }
  void clear();

 private:
  /// A deformed shape; kept for the item at the same place of the next frame.
  struct Deformed {
    const MeshBuffers* base = nullptr;
    BufferHandle shape;
    VertexArrayHandle vertex_array;
  };

  GpuModel& upload(const std::shared_ptr<const Model>& model);
  void add_instance(const Instance& instance);
  void add_deformed(DrawItem item, const MeshBuffers& mesh, const std::vector<ShapeVertex>& shape);

  const Gl* gl_;
  std::map<const Model*, GpuModel> models_;
  std::vector<Deformed> deformed_;
  std::size_t deformed_used_ = 0;
  std::vector<DrawItem> items_;
  std::uint64_t uploads_ = 0;
  std::uint64_t signature_ = 0;
};

/// Corners of the items' boxes in the world.
std::vector<glm::vec3> world_box_points(const std::vector<DrawItem>& items);

}  // namespace planecast::render
