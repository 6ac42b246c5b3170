#include "engine/sequence/synth/painted_scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

namespace planecast::engine::synth {

namespace {

constexpr int kGutter =
    6;  // texels repeated around a patch, so that mip levels take nothing else in
constexpr int kMaxSide = 2048;
constexpr int kAtlasWidth = 2048;
constexpr int kAtlasHeight = 16384;    // the largest texture; what is beyond goes into another
constexpr int kAtlasPatchSide = 1000;  // larger ones get a texture of their own

struct Painted {
  int width = 0;  ///< without the gutter
  int height = 0;
  std::shared_ptr<render::ImageU8> image;  ///< with it
};

/// A camera's response: straight up to 0.6, then a shoulder that reaches white at about 3.
float tone(float linear) {
  constexpr float kKnee = 0.6F;
  if (linear <= kKnee) return std::max(linear, 0.0F);
  return kKnee + (1.0F - kKnee) * (1.0F - std::exp(-(linear - kKnee) / (1.0F - kKnee)));
}

/// sRGB byte of a linear value in [0, 1], by table.
std::uint8_t encode(float linear) {
  static const std::array<std::uint8_t, 4097> table = [] {
    std::array<std::uint8_t, 4097> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      // The table's step is taken in the square root, where sRGB is nearly straight.
      const float root = static_cast<float>(i) / 4096.0F;
      const float x = root * root;
      const float e = x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1.0F / 2.4F) - 0.055F;
      values[i] = static_cast<std::uint8_t>(std::lround(255.0F * e));
    }
    return values;
  }();
  return table[static_cast<std::size_t>(std::sqrt(std::min(linear, 1.0F)) * 4096.0F + 0.5F)];
}

Painted paint_patch(const RoomModel& model, const std::vector<Color>& mean_colors,
                    const RayCaster& rays, int index, float detail) {
  const Patch& patch = model.patches[static_cast<std::size_t>(index)];
  BakeOptions options;
  options.detail = std::min(detail, 1.5F);
  const LightMap light = bake_light(model, mean_colors, rays, index, options);
  const float density = patch.texels_per_m * detail;
  Painted painted;
  painted.width = std::clamp(static_cast<int>(patch.width_m * density), 4, kMaxSide);
  painted.height = std::clamp(static_cast<int>(patch.height_m * density), 4, kMaxSide);
  painted.image = std::make_shared<render::ImageU8>(painted.width + 2 * kGutter,
                                                    painted.height + 2 * kGutter, 3);
  std::uint8_t* to = painted.image->pixels.data();
  for (int y = 0; y < painted.image->height; ++y) {
    const float v = (static_cast<float>(std::clamp(y - kGutter, 0, painted.height - 1)) + 0.5F) /
                    static_cast<float>(painted.height);
    for (int x = 0; x < painted.image->width; ++x, to += 3) {
      const float u = (static_cast<float>(std::clamp(x - kGutter, 0, painted.width - 1)) + 0.5F) /
                      static_cast<float>(painted.width);
      const Color reflectance = patch.texture(u * patch.width_m, v * patch.height_m);
      const Color color = reflectance.cwiseProduct(light.at(u, v)) * model.exposure;
      for (int c = 0; c < 3; ++c) to[c] = encode(tone(color[c]));
    }
  }
  return painted;
}

std::vector<Painted> paint_patches(const RoomModel& model, float detail) {
  std::vector<Color> mean_colors;
  for (const Patch& patch : model.patches) mean_colors.push_back(mean_color(patch));
  const RayCaster rays(model);
  std::vector<Painted> painted(model.patches.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < painted.size(); i = next++) {
      painted[i] = paint_patch(model, mean_colors, rays, static_cast<int>(i), detail);
    }
  };
  std::thread other(work);
  work();
  other.join();
  return painted;
}

/// Adds a patch's triangles with texture coordinates for its place in a texture.
void append_patch(const Patch& patch, const Painted& painted, int left, int top, int image_width,
                  int image_height, render::SurfaceMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int j = 0; j <= patch.rows; ++j) {
    for (int i = 0; i <= patch.cols; ++i) {
      const auto at = static_cast<std::size_t>(j * (patch.cols + 1) + i);
      const Eigen::Vector3f& p = patch.positions[at];
      const Eigen::Vector3f& n = patch.normals[at];
      mesh.positions.emplace_back(p.x(), p.y(), p.z());
      mesh.normals.emplace_back(n.x(), n.y(), n.z());
      const float u = static_cast<float>(i) / static_cast<float>(patch.cols);
      const float v = static_cast<float>(j) / static_cast<float>(patch.rows);
      mesh.uvs.emplace_back(
          (static_cast<float>(left + kGutter) + u * static_cast<float>(painted.width)) /
              static_cast<float>(image_width),
          (static_cast<float>(top + kGutter) + v * static_cast<float>(painted.height)) /
              static_cast<float>(image_height));
    }
  }
  const auto stride = static_cast<std::uint32_t>(patch.cols + 1);
  for (int j = 0; j < patch.rows; ++j) {
    for (int i = 0; i < patch.cols; ++i) {
      const std::uint32_t a =
          first + static_cast<std::uint32_t>(j) * stride + static_cast<std::uint32_t>(i);
      for (const std::uint32_t k : {a, a + 1, a + stride + 1, a, a + stride + 1, a + stride}) {
        mesh.indices.push_back(k);
      }
    }
  }
}

bool goes_into_atlas(const Patch& patch, const Painted& painted) {
  return patch.label == 0 && painted.image->width <= kAtlasPatchSide &&
         painted.image->height <= kAtlasPatchSide;
}

/// Packs the patches of `order` from `begin` on in shelves of one texture and makes one mesh of
/// them; returns the first that found no room.
std::size_t add_atlas_page(const RoomModel& model, const std::vector<Painted>& painted,
                           const std::vector<std::size_t>& order, std::size_t begin,
                           std::vector<render::SurfaceMesh>& surfaces) {
  std::vector<std::pair<int, int>> corner;
  int x = 0;
  int y = 0;
  int shelf = 0;
  std::size_t end = begin;
  for (; end < order.size(); ++end) {
    const render::ImageU8& image = *painted[order[end]].image;
    if (x + image.width > kAtlasWidth) {
      x = 0;
      y += shelf;
      shelf = 0;
    }
    if (y + image.height > kAtlasHeight) break;
    corner.emplace_back(x, y);
    x += image.width;
    shelf = std::max(shelf, image.height);
  }
  auto atlas = std::make_shared<render::ImageU8>(kAtlasWidth, y + shelf, 3);
  render::SurfaceMesh mesh;
  for (std::size_t o = begin; o < end; ++o) {
    const Painted& patch = painted[order[o]];
    const render::ImageU8& image = *patch.image;
    const auto [left, top] = corner[o - begin];
    for (int row = 0; row < image.height; ++row) {
      const auto from = image.pixels.begin() + static_cast<std::ptrdiff_t>(row) * image.width * 3;
      std::copy(from, from + image.width * 3,
                atlas->pixels.begin() +
                    (static_cast<std::ptrdiff_t>(top + row) * kAtlasWidth + left) * 3);
    }
    append_patch(model.patches[order[o]], patch, left, top, atlas->width, atlas->height, mesh);
  }
  mesh.base_color = atlas;
  surfaces.push_back(std::move(mesh));
  return end;
}

/// Small unlabelled patches share textures and meshes.
void add_atlases(const RoomModel& model, const std::vector<Painted>& painted,
                 std::vector<render::SurfaceMesh>& surfaces) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < painted.size(); ++i) {
    if (goes_into_atlas(model.patches[i], painted[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&painted](std::size_t a, std::size_t b) {
    return painted[a].image->height > painted[b].image->height;
  });
  for (std::size_t next = 0; next < order.size();) {
    next = add_atlas_page(model, painted, order, next, surfaces);
  }
}

}  // namespace

render::OpaqueScene paint_scene(const RoomModel& model, float detail) {
  const std::vector<Painted> painted = paint_patches(model, detail);
  render::OpaqueScene scene;
  add_atlases(model, painted, scene.surfaces);
  // What was added last stands before what was added first, the walls: drawn in this order, most of
  // what is hidden is never shaded.
  for (std::size_t i = painted.size(); i-- > 0;) {
    if (goes_into_atlas(model.patches[i], painted[i])) continue;
    render::SurfaceMesh mesh;
    append_patch(model.patches[i], painted[i], 0, 0, painted[i].image->width,
                 painted[i].image->height, mesh);
    mesh.base_color = painted[i].image;
    mesh.label = model.patches[i].label;
    scene.surfaces.push_back(std::move(mesh));
  }
  render::Sun none;
  none.radiance = glm::vec3(0.0F);
  none.casts_shadow = false;
  scene.light = render::Light::uniform(glm::vec3(1.0F), none);
  return scene;
}

}  // namespace planecast::engine::synth
