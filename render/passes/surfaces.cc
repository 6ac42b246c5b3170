#include "render/passes/surfaces.h"

#include <algorithm>

#include "render/passes/content_hash.h"
#include "render/passes/texture_units.h"

namespace planecast::render {
namespace {

std::uint64_t geometry_hash(const SurfaceMesh& surface) {
  ContentHash hash;
  hash.add(surface.positions);
  hash.add(surface.normals);
  hash.add(surface.uvs);
  hash.add(surface.indices);
  return hash.value();
}

/// Triangles whose three indices exist; an index beyond the vertices must never reach the driver.
std::vector<std::uint32_t> valid_indices(const SurfaceMesh& surface) {
  std::vector<std::uint32_t> indices;
  indices.reserve(surface.indices.size());
  const std::size_t count = surface.positions.size();
  for (std::size_t i = 0; i + 2 < surface.indices.size(); i += 3) {
    const std::uint32_t* corner = &surface.indices[i];
    if (std::max({corner[0], corner[1], corner[2]}) < count) {
      indices.insert(indices.end(), corner, corner + 3);
    }
  }
  return indices;
}

MeshBuffers upload_surface(const Gl& gl, const SurfaceMesh& surface) {
  const std::size_t count = surface.positions.size();
  std::vector<ShapeVertex> shape(count);
  std::vector<SurfaceVertex> attributes(count);
  for (std::size_t i = 0; i < count; ++i) {
    shape[i].position = surface.positions[i];
    shape[i].normal = i < surface.normals.size() ? surface.normals[i] : glm::vec3(0.0F, 0.0F, 1.0F);
    if (i < surface.uvs.size()) attributes[i].uv0 = surface.uvs[i];
  }
  return upload_mesh(gl, shape, attributes, valid_indices(surface));
}

Box bounding_box(const std::vector<glm::vec3>& points) {
  if (points.empty()) return {};
  Box box{points.front(), points.front()};
  for (const glm::vec3& point : points) {
    box.min = glm::min(box.min, point);
    box.max = glm::max(box.max, point);
  }
  return box;
}

}  // namespace

void SurfaceSet::update(const std::vector<SurfaceMesh>& surfaces) {
  std::erase_if(textures_, [](const auto& item) { return item.second.image.expired(); });
  std::map<std::uint64_t, Entry> kept;
  ContentHash signature;
  std::vector<std::uint64_t> order;
  for (const SurfaceMesh& surface : surfaces) {
    const std::uint64_t hash = geometry_hash(surface);
    order.push_back(hash);
    signature.add(hash);
    if (kept.contains(hash)) continue;
    const auto known = entries_.find(hash);
    if (known != entries_.end()) {
      kept.emplace(hash, std::move(known->second));
    } else {
      kept.emplace(hash, Entry{upload_surface(*gl_, surface), bounding_box(surface.positions)});
    }
  }
  entries_ = std::move(kept);
  signature_ = signature.value();

  drawn_.clear();
  drawn_textures_.clear();
  box_points_.clear();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Entry& entry = entries_.at(order[i]);
    drawn_.push_back(&entry);
    drawn_textures_.push_back(texture_of(surfaces[i]));
    const auto corners = box_corners(entry.box, glm::mat4(1.0F));
    if (!surfaces[i].positions.empty()) {
      box_points_.insert(box_points_.end(), corners.begin(), corners.end());
    }
  }
}

void SurfaceSet::clear() {
  drawn_.clear();
  drawn_textures_.clear();
  entries_.clear();
  textures_.clear();
}

const SurfaceSet::Texture* SurfaceSet::texture_of(const SurfaceMesh& surface) {
  const auto& image = surface.base_color;
  if (image == nullptr || image->empty()) return nullptr;
  const auto known = textures_.find(image.get());
  if (known != textures_.end()) return &known->second;
  TextureOptions options;
  options.srgb = true;
  Texture texture{image, upload_image(*gl_, *image, options)};
  return &textures_.emplace(image.get(), std::move(texture)).first->second;
}

void SurfaceSet::draw_shadow(ShaderLibrary& shaders, const ShadowProjection& projection,
                             const glm::vec3& direction_to_light) const {
  const Program& program = shaders.get("surface_shadow.vert", "surface_shadow.frag");
  program.use();
  program.set("u_clip_from_world", projection.clip_from_world);
  program.set("u_to_light", direction_to_light);
  for (const Entry* entry : drawn_) entry->mesh.draw(*gl_);
}

void SurfaceSet::draw_color(ShaderLibrary& shaders, const OpaqueScene& scene, const Camera& camera,
                            const ShadowMap* shadow) const {
  const glm::mat4 clip_from_world = clip_from_camera(camera) * camera.camera_from_world;
  const bool sun = scene.light.sun.radiance != glm::vec3(0.0F);
  const Program* previous = nullptr;
  for (std::size_t i = 0; i < drawn_.size(); ++i) {
    std::vector<std::string> defines;
    if (drawn_textures_[i] != nullptr) defines.emplace_back("TEXTURE");
    if (sun) defines.emplace_back("SUN");
    if (sun && shadow != nullptr) defines.emplace_back("SHADOWS");
    const Program& program = shaders.get("surface.vert", "surface.frag", defines);
    if (&program != previous) {
      program.use();
      program.set("u_clip_from_world", clip_from_world);
      program.set("u_ambient_sh", std::span<const glm::vec3>(scene.light.ambient_sh));
      program.set("u_exposure", scene.exposure);
      program.set("u_eye", camera_position(camera));
      program.set("u_to_light", glm::normalize(scene.light.sun.direction_to_light));
      program.set("u_sun_radiance", scene.light.sun.radiance);
      program.set("u_base_color", static_cast<int>(kUnitBaseColor));
      if (shadow != nullptr) shadow->bind(program, scene.light.sun);
      previous = &program;
    }
    const SurfaceMesh& surface = scene.surfaces[i];
    program.set("u_color_factor", surface.color_factor);
    program.set("u_roughness", std::clamp(surface.roughness, 0.045F, 1.0F));
    if (drawn_textures_[i] != nullptr) {
      gl_->BindTextureUnit(kUnitBaseColor, drawn_textures_[i]->handle.id());
    }
    drawn_[i]->mesh.draw(*gl_);
  }
}

void SurfaceSet::draw_geometry(ShaderLibrary& shaders, const std::vector<SurfaceMesh>& surfaces,
                               const Camera& camera) const {
  const Program& program = shaders.get("geometry.vert", "geometry.frag");
  program.use();
  program.set("u_clip_from_model", clip_from_camera(camera) * camera.camera_from_world);
  for (std::size_t i = 0; i < drawn_.size(); ++i) {
    program.set("u_label", surfaces[i].label);
    drawn_[i]->mesh.draw(*gl_);
  }
}

}  // namespace planecast::render
