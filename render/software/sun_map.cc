#include "render/software/sun_map.h"

#include <algorithm>
#include <cmath>

#include "render/passes/sun_shadow.h"

namespace planecast::render {
namespace {

constexpr F4 kFarthest = {1.0F, 1.0F, 1.0F, 1.0F};

}  // namespace

SunMap::SunMap(int size)
    : size_(size), blocks_(static_cast<std::size_t>(size / 4) * static_cast<std::size_t>(size)) {}

void SunMap::draw(const ShadowProjection& projection, const std::vector<DrawItem>& items,
                  const PosedMeshes& meshes, float detail_texels) {
  projection_ = projection;
  std::ranges::fill(blocks_, kFarthest);
  const float half = 0.5F * static_cast<float>(size_);
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].mode != GL_TRIANGLES) continue;
    const std::vector<WorldVertex>& vertices = meshes[i].vertices;
    screen_.resize(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      const glm::vec4 p = projection.clip_from_world * glm::vec4(vertices[v].position, 1.0F);
      screen_[v] = snapped(half * p.x + half - 0.5F, half * p.y + half - 0.5F, p.z, 1.0F);
    }
    const auto& indices = triangles_of(items[i], detail_texels * projection.texel_m);
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
      draw_triangle(screen_[indices[k]], screen_[indices[k + 1]], screen_[indices[k + 2]]);
    }
  }
}

void SunMap::draw_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
  const DepthSlopes slopes = depth_slopes(a, b, c);
  if (!slopes.any) return;
  const float steepest = std::max(std::abs(slopes.x), std::abs(slopes.y));
  const float offset = kCasterSlopeTexels * static_cast<float>(kSubpixel) * steepest;
  const SamplePattern pattern = SamplePattern::pixel_centres();
  const LinearValue depth_at(pattern, a, a.depth + offset, slopes.x, slopes.y);
  const int columns = size_ / 4;
  visit_covered({a, b, c}, pattern, columns, size_, [&](int x, int y, const I4& covered) {
    F4& block = blocks_[static_cast<std::size_t>(y * columns + x)];
    const F4 depth = depth_at.at(x, y);
    const I4 nearer = covered & (depth < block);
    block = nearer ? depth : block;
  });
}

}  // namespace planecast::render
