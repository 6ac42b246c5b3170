#include "render/software/visible_triangles.h"

#include <algorithm>

#include "render/passes/model_passes.h"
#include "render/passes/view.h"
#include "render/software/screen_polygon.h"

namespace planecast::render {
namespace {

SurfaceMap map_of(const DrawItem& item, const TextureSlot& slot, TextureUse use) {
  if (slot.texture < 0) return {};
  return {&texture_in_memory(item, slot, use), slot};
}

void project(const std::vector<WorldVertex>& vertices, const Camera& camera, const Window& window,
             std::vector<ScreenVertex>& screen) {
  const glm::vec2 depth = depth_coefficients(camera);
  const float left = camera.cx - static_cast<float>(window.rect.x);
  const float top = camera.cy - static_cast<float>(window.rect.y);
  screen.resize(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const glm::vec3 p(camera.camera_from_world * glm::vec4(vertices[i].position, 1.0F));
    const float inverse = 1.0F / std::max(p.z, camera.near_plane);
    screen[i] = snapped(camera.fx * p.x * inverse + left, camera.fy * p.y * inverse + top,
                        depth.x + depth.y * inverse, inverse);
  }
}

}  // namespace

void VisibleTriangles::collect(const std::vector<DrawItem>& items, const PosedMeshes& meshes,
                               const Camera& camera, const Window& window, float detail_px) {
  surfaces_.clear();
  triangles_.assign(1, {});
  screen_.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    project(meshes[i].vertices, camera, window, screen_[i]);
    add_surface(items[i], meshes[i], screen_[i]);
    add_triangles(items[i], camera, window, detail_px);
  }
}

void VisibleTriangles::add_surface(const DrawItem& item, const PosedMesh& mesh,
                                   const std::vector<ScreenVertex>& screen) {
  const Material& material = *item.material;
  ObjectSurface surface;
  surface.vertices = mesh.vertices.data();
  surface.screen = screen.data();
  surface.material = &material;
  surface.unlit = material.unlit || item.unlit;
  surface.colored = mesh.colored;
  surface.encoded_color = base_color_use(item) == TextureUse::kEncoded;
  surface.base_color = map_of(item, material.base_color_map, base_color_use(item));
  if (!surface.unlit) {
    surface.metallic_roughness =
        map_of(item, material.metallic_roughness_map, TextureUse::kNumbers);
    surface.normal = map_of(item, material.normal_map, TextureUse::kNumbers);
    surface.occlusion = map_of(item, material.occlusion_map, TextureUse::kNumbers);
    surface.emissive = map_of(item, material.emissive_map, TextureUse::kColor);
  }
  surfaces_.push_back(surface);
}

/// Of the item that was added last.
void VisibleTriangles::add_triangles(const DrawItem& item, const Camera& camera,
                                     const Window& window, float detail_px) {
  const auto surface = static_cast<std::uint16_t>(surfaces_.size() - 1);
  const auto& indices = triangles_of(item, allowed_error_m(item, camera, detail_px));
  const bool clockwise_is_front = front_face(camera, item.world_from_shape) == GL_CW;
  const bool both = item.material->double_sided;
  const ScreenVertex* screen = surfaces_.back().screen;
  const int right = kSubpixel * window.rect.width;
  const int bottom = kSubpixel * window.rect.height;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const ScreenVertex& a = screen[indices[i]];
    const ScreenVertex& b = screen[indices[i + 1]];
    const ScreenVertex& c = screen[indices[i + 2]];
    const std::int64_t area2 = (static_cast<std::int64_t>(b.x) - a.x) * (c.y - a.y) -
                               (static_cast<std::int64_t>(c.x) - a.x) * (b.y - a.y);
    if (area2 == 0) continue;
    // OpenGL looks at the target with its first row at the bottom: positive is counter-clockwise.
    const bool front = (area2 < 0) == clockwise_is_front;
    if (!front && !both) continue;
    if (std::min({a.x, b.x, c.x}) >= right || std::max({a.x, b.x, c.x}) < 0 ||
        std::min({a.y, b.y, c.y}) >= bottom || std::max({a.y, b.y, c.y}) < 0) {
      continue;
    }
    triangles_.push_back({{indices[i], indices[i + 1], indices[i + 2]}, surface, front});
  }
}

void VisibleTriangles::draw(SampleGrid& grid) const {
  for (std::size_t i = 1; i < triangles_.size(); ++i) {
    const ObjectTriangle& triangle = triangles_[i];
    const ScreenVertex* screen = surfaces_[triangle.surface].screen;
    grid.draw(screen[triangle.corners[0]], screen[triangle.corners[1]], screen[triangle.corners[2]],
              static_cast<std::int32_t>(i));
  }
}

}  // namespace planecast::render
