#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "render/gl/image_texture.h"
#include "render/gl/mesh_buffers.h"
#include "render/gl/program.h"
#include "render/passes/shadow_map.h"
#include "render/passes/view.h"
#include "render/scene.h"

namespace planecast::render {

/// The surfaces of opaque scenes on the GPU. A surface is known again by its content, a texture by
/// its image object, so nothing is uploaded twice and nothing stale is drawn.
class SurfaceSet {
 public:
  explicit SurfaceSet(const Gl& gl) : gl_(&gl) {}

  /// Makes `surfaces` the ones to draw; uploads what is new and drops what is gone.
  void update(const std::vector<SurfaceMesh>& surfaces);
  void clear();

  /// Corners of the boxes of all surfaces, world.
  const std::vector<glm::vec3>& box_points() const { return box_points_; }
  /// Changes when the geometry does.
  std::uint64_t signature() const { return signature_; }

  void draw_shadow(ShaderLibrary& shaders, const ShadowProjection& projection,
                   const glm::vec3& direction_to_light) const;
  /// `shadow` null: no shadows.
  void draw_color(ShaderLibrary& shaders, const OpaqueScene& scene, const Camera& camera,
                  const ShadowMap* shadow) const;
  void draw_geometry(ShaderLibrary& shaders, const std::vector<SurfaceMesh>& surfaces,
                     const Camera& camera) const;

 private:
  struct Texture {
    std::weak_ptr<const ImageU8> image;
    TextureHandle handle;
  };
  struct Entry {
    MeshBuffers mesh;
    Box box;
  };

  const Texture* texture_of(const SurfaceMesh& surface);

  const Gl* gl_;
  std::map<std::uint64_t, Entry> entries_;
  std::map<const ImageU8*, Texture> textures_;
  std::vector<const Entry*> drawn_;
  std::vector<const Texture*> drawn_textures_;
  std::vector<glm::vec3> box_points_;
  std::uint64_t signature_ = 0;
};

}  // namespace planecast::render
