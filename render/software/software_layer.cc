#include "render/software/software_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "render/passes/content_hash.h"
#include "render/passes/model_passes.h"
#include "render/passes/occluders.h"
#include "render/passes/view.h"
#include "render/software/baked_shadow.h"
#include "render/software/screen_polygon.h"

namespace planecast::render {
namespace {

/// Beyond these the snapped coordinates would not be exact.
constexpr float kFarthestPixel = 16000.0F;
constexpr std::size_t kMostSurfaces = 65535;

bool known_material(const Material& material) {
  return material.alpha_mode == AlphaMode::kOpaque && material.transmission == 0.0F &&
         material.clearcoat == 0.0F && material.sheen_color == glm::vec3(0.0F) &&
         plain_reflectance(material);
}

/// In front of the camera with all its corners, and not so near that it is far larger than the
/// picture.
bool well_in_front(const DrawItem& item, const Camera& camera) {
  for (const glm::vec3& corner :
       box_corners(item.box, camera.camera_from_world * item.world_from_shape)) {
    if (!(corner.z > camera.near_plane)) return false;
    const float u = camera.fx * corner.x / corner.z + camera.cx;
    const float v = camera.fy * corner.y / corner.z + camera.cy;
    if (!(std::abs(u) < kFarthestPixel && std::abs(v) < kFarthestPixel)) return false;
  }
  return true;
}

SurfaceMap map_of(const DrawItem& item, const TextureSlot& slot, TextureUse use) {
  if (slot.texture < 0) return {};
  return {&texture_in_memory(item, slot, use), slot};
}

}  // namespace

bool SoftwareLayer::can_draw(const LayerScene& scene, const Camera& camera,
                             const std::vector<DrawItem>& items, bool lamps, bool still) {
  if (scene.light.environment != nullptr || scene.tone_map != ToneMap::kNone) return false;
  if (lamps || !still || scene.occluder_depth != nullptr || items.size() > kMostSurfaces) {
    return false;
  }
  return std::ranges::all_of(items, [&](const DrawItem& item) {
    return item.mode == GL_TRIANGLES && known_material(*item.material) &&
           well_in_front(item, camera);
  });
}

void SoftwareLayer::clear() { posed_.clear(); }

void SoftwareLayer::draw(const SoftwareInput& input, const Window& window, Layer& layer) {
  const Camera& camera = *input.camera;
  surfaces_.clear();
  triangles_.assign(1, {});  // number 0 is nothing
  posed_.resize(input.items->size());
  for (std::size_t i = 0; i < posed_.size(); ++i) {
    const DrawItem& item = (*input.items)[i];
    pose(item, posed_[i]);
    project(camera, window, posed_[i]);
    add_surface(item, posed_[i]);
    add_triangles(item, input, window, static_cast<std::uint16_t>(i));
  }
  samples_.begin(window.rect.width, window.rect.height);
  draw_occluders(input, window, samples_);
  draw_objects(samples_);
  draw_shadows(input, window);
  find_fragments();
  FragmentShader(surfaces_, triangles_, input.light, input.shadow).shade(fragments_);
  write_colors(window, layer);
  if (input.scene->with_depth) {
    centres_.begin(window.rect.width, window.rect.height);
    draw_occluders(input, window, centres_);
    draw_objects(centres_);
    write_depth(input, window, layer);
  }
}

void SoftwareLayer::pose(const DrawItem& item, Posed& posed) const {
  ContentHash hash;
  hash.add(item.gpu->serial);
  hash.add(item.primitive);
  hash.add(item.shape_version);
  hash.add(item.world_from_shape);
  if (posed.signature == hash.value()) return;
  posed.signature = hash.value();
  const std::vector<ShapeVertex>& shape = *item.shape;
  const std::vector<SurfaceVertex>& surface = item.primitive->surface;
  const glm::mat4& world = item.world_from_shape;
  const glm::mat3 linear(world);
  const glm::mat3 normals = normal_matrix(world);
  posed.colored = false;
  posed.vertices.resize(shape.size());
  for (std::size_t i = 0; i < shape.size(); ++i) {
    WorldVertex& vertex = posed.vertices[i];
    const glm::vec3 normal = normals * shape[i].normal;
    const float length2 = glm::dot(normal, normal);
    vertex.position = glm::vec3(world * glm::vec4(shape[i].position, 1.0F));
    vertex.normal = length2 > 0.0F ? normal / std::sqrt(length2) : normal;
    vertex.tangent = glm::vec4(linear * glm::vec3(shape[i].tangent), shape[i].tangent.w);
    const SurfaceVertex values = i < surface.size() ? surface[i] : SurfaceVertex{};
    vertex.u0 = values.uv0.x;
    vertex.v0 = values.uv0.y;
    vertex.uv1 = values.uv1;
    vertex.color = values.color;
    posed.colored = posed.colored || values.color != glm::vec4(1.0F);
  }
}

void SoftwareLayer::project(const Camera& camera, const Window& window, Posed& posed) const {
  const glm::vec2 depth = depth_coefficients(camera);
  const float left = camera.cx - static_cast<float>(window.rect.x);
  const float top = camera.cy - static_cast<float>(window.rect.y);
  posed.screen.resize(posed.vertices.size());
  for (std::size_t i = 0; i < posed.vertices.size(); ++i) {
    const glm::vec3 p(camera.camera_from_world * glm::vec4(posed.vertices[i].position, 1.0F));
    const float inverse = 1.0F / std::max(p.z, camera.near_plane);
    posed.screen[i] = snapped(camera.fx * p.x * inverse + left, camera.fy * p.y * inverse + top,
                              depth.x + depth.y * inverse, inverse);
  }
}

void SoftwareLayer::add_surface(const DrawItem& item, const Posed& posed) {
  const Material& material = *item.material;
  ObjectSurface surface;
  surface.vertices = posed.vertices.data();
  surface.screen = posed.screen.data();
  surface.material = &material;
  surface.unlit = material.unlit || item.unlit;
  surface.colored = posed.colored;
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

/// Triangles that face the right way and touch the window.
void SoftwareLayer::add_triangles(const DrawItem& item, const SoftwareInput& input,
                                  const Window& window, std::uint16_t surface) {
  const Camera& camera = *input.camera;
  const std::size_t level = item.level(allowed_error_m(item, camera, input.detail_px));
  const std::vector<std::uint32_t>& indices =
      level == 0 ? item.primitive->indices : item.primitive->details[level - 1].indices;
  const bool clockwise_is_front = front_face(camera, item.world_from_shape) == GL_CW;
  const bool both = item.material->double_sided;
  const ScreenVertex* screen = surfaces_[surface].screen;
  const int right = 256 * window.rect.width;
  const int bottom = 256 * window.rect.height;
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

void SoftwareLayer::draw_occluders(const SoftwareInput& input, const Window& window,
                                   SampleGrid& grid) const {
  const Camera& camera = *input.camera;
  const glm::mat4 retreat = glm::scale(glm::mat4(1.0F), glm::vec3(1.0F + kOccluderRetreat));
  const glm::mat4 camera_from_world = retreat * camera.camera_from_world;
  for (const PlanePatch& patch : input.scene->occluders) {
    if (!drawable(patch)) continue;
    std::vector<std::vector<glm::vec2>> rings = {
        clip_to_window(patch.outer, camera_from_world, camera, window)};
    for (const auto& hole : patch.holes) {
      rings.push_back(clip_to_window(hole, camera_from_world, camera, window));
    }
    const SampleGrid::Area area = grid.mark(rings);
    const glm::vec4 equation =
        glm::transpose(glm::inverse(camera_from_world)) * plane_frame(patch).equation();
    grid.fill_marked(area, depth_of_plane(equation, camera, window));
  }
}

void SoftwareLayer::draw_shadows(const SoftwareInput& input, const Window& window) {
  const auto pixels =
      static_cast<std::size_t>(window.rect.width) * static_cast<std::size_t>(window.rect.height);
  shadow_alpha_.assign(pixels, 0);
  const Camera& camera = *input.camera;
  const glm::mat4 equation_from_world = glm::transpose(glm::inverse(camera.camera_from_world));
  for (const ShadowOnPlane& shadow : *input.shadows) {
    const auto corners = shadow.frame.corners(shadow.dark);
    const SampleGrid::Area area =
        samples_.mark({clip_to_window(corners, camera.camera_from_world, camera, window)});
    const DepthPlane depth =
        depth_of_plane(equation_from_world * shadow.frame.equation(), camera, window);
    BakedShadow baked(shadow, camera, input.scene->shadow_strength);
    for (int y = area.y0; y < area.y1; ++y) draw_shadow_row(baked, depth, window, area, y);
  }
}

void SoftwareLayer::draw_shadow_row(BakedShadow& shadow, const DepthPlane& depth,
                                    const Window& window, const SampleGrid::Area& area, int y) {
  std::uint32_t* row =
      &shadow_alpha_[static_cast<std::size_t>(y) * static_cast<std::size_t>(window.rect.width)];
  constexpr int kStep = static_cast<int>(kLanes);
  std::array<unsigned, kLanes> seen{};
  LaneInt alphas;
  for (int first = area.x0; first < area.x1; first += kStep) {
    const int count = std::min(kStep, area.x1 - first);
    unsigned any = 0;
    for (int i = 0; i < count; ++i) {
      const int x = first + i;
      // What an object covers needs no shadow.
      const unsigned bare = bits_of(samples_.block(x, y).triangle == 0);
      const unsigned bits = samples_.take_marks(x, y, depth) & bare;
      seen[static_cast<std::size_t>(i)] = bits;
      any |= bits;
    }
    if (any == 0) continue;
    shadow.read(first + window.rect.x, y + window.rect.y, alphas);
    for (int i = 0; i < count; ++i) {
      const auto lane = static_cast<std::size_t>(i);
      if (seen[lane] == 0 || alphas[lane] == 0) continue;
      row[first + i] = darkened(row[first + i], seen[lane], static_cast<unsigned>(alphas[lane]));
    }
  }
}

void SoftwareLayer::draw_objects(SampleGrid& grid) const {
  for (std::size_t i = 1; i < triangles_.size(); ++i) {
    const ObjectTriangle& triangle = triangles_[i];
    const ScreenVertex* screen = surfaces_[triangle.surface].screen;
    grid.draw(screen[triangle.corners[0]], screen[triangle.corners[1]], screen[triangle.corners[2]],
              static_cast<std::int32_t>(i));
  }
}

/// Each triangle that a pixel's samples show, once.
void SoftwareLayer::find_fragments() {
  fragments_.clear();
  for (int y = 0; y < samples_.rows(); ++y) {
    const auto [begin, end] = samples_.drawn_in(y);
    for (int x = begin; x < end; ++x) {
      const I4 triangle = samples_.block(x, y).triangle;
      const std::int32_t first = triangle[0];
      const bool same = bits_of(triangle == I4{first, first, first, first}) == 15U;
      if (same && first == 0) continue;
      const std::size_t of_pixel = fragments_.size();
      for (int s = 0; s < 4; ++s) {
        if (triangle[s] == 0) continue;
        const auto known = std::find_if(
            fragments_.begin() + static_cast<std::ptrdiff_t>(of_pixel), fragments_.end(),
            [&](const Fragment& fragment) { return fragment.triangle == triangle[s]; });
        if (known != fragments_.end()) {
          ++known->samples;
          continue;
        }
        fragments_.push_back({static_cast<std::uint16_t>(x),
                              static_cast<std::uint16_t>(y),
                              triangle[s],
                              static_cast<std::uint8_t>(same ? 4 : 1),
                              {}});
        if (same) break;
      }
    }
  }
}

/// The mean of each pixel's samples, rounded to nearest.
void SoftwareLayer::write_colors(const Window& window, Layer& layer) const {
  const Layer::Rect& rect = window.rect;
  const auto width = static_cast<std::size_t>(rect.width);
  const auto row_of = [&](int y) {
    return &layer.rgba.pixels[4 * (static_cast<std::size_t>(rect.y + y) *
                                       static_cast<std::size_t>(window.picture_width) +
                                   static_cast<std::size_t>(rect.x))];
  };
  auto next = fragments_.begin();
  for (int y = 0; y < rect.height; ++y) {
    std::uint8_t* row = row_of(y);
    const std::uint32_t* shadow = &shadow_alpha_[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < rect.width; ++x) {
      const bool object = next != fragments_.end() && next->y == y && next->x == x;
      if (!object && shadow[x] == 0) continue;
      std::uint8_t* rgba = &row[4 * static_cast<std::size_t>(x)];
      if (object && next->samples == 4) {
        std::ranges::copy(next->color, rgba);
        rgba[3] = 255;
        ++next;
        continue;
      }
      if (!object && shadow[x] == (shadow[x] & 0xFFU) * 0x01010101U) {
        rgba[3] = static_cast<std::uint8_t>(shadow[x] & 0xFFU);
        continue;
      }
      std::array<int, 4> sum{};
      for (; next != fragments_.end() && next->y == y && next->x == x; ++next) {
        for (std::size_t c = 0; c < 3; ++c) sum[c] += next->samples * next->color[c];
        sum[3] += 255 * next->samples;
      }
      const I4 triangle = samples_.block(x, y).triangle;
      for (int s = 0; s < 4; ++s) {
        if (triangle[s] == 0) sum[3] += static_cast<int>((shadow[x] >> (8 * s)) & 0xFFU);
      }
      for (std::size_t c = 0; c < 4; ++c) {
        rgba[c] = static_cast<std::uint8_t>((sum[c] + 2) / 4);
      }
    }
  }
}

void SoftwareLayer::write_depth(const SoftwareInput& input, const Window& window,
                                Layer& layer) const {
  const glm::vec2 depth = depth_coefficients(*input.camera);
  const Layer::Rect& rect = window.rect;
  for (int y = 0; y < rect.height; ++y) {
    float* row = &layer.depth.pixels[static_cast<std::size_t>(rect.y + y) *
                                         static_cast<std::size_t>(window.picture_width) +
                                     static_cast<std::size_t>(rect.x)];
    for (int x = 0; x < rect.width; ++x) {
      const SampleGrid::Block& block = centres_.block(x / 4, y);
      if (block.triangle[x % 4] != 0) row[x] = depth.y / (block.depth[x % 4] - depth.x);
    }
  }
}

}  // namespace planecast::render
