#include "render/software/software_layer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "render/passes/occluders.h"
#include "render/passes/view.h"
#include "render/software/fragment_shader.h"
#include "render/software/screen_polygon.h"

namespace planecast::render {
namespace {

constexpr unsigned kAllSamples = 15;

}  // namespace

void SoftwareLayer::draw(const SoftwareInput& input, const Window& window, PassClock& clock,
                         Layer& layer) {
  visible_.collect(*input.items, *input.meshes, *input.camera, window, input.detail_px);
  samples_.begin(window.rect.width, window.rect.height);
  draw_occluders(input, window, samples_);
  // What an object covers needs no shadow, unless a depth image takes the object away again.
  const bool shadows_first = input.shading.occlusion.depth != nullptr;
  if (shadows_first) draw_shadows(input, window);
  visible_.draw(samples_);
  clock.end_of("rasterising");
  if (!shadows_first) draw_shadows(input, window);
  clock.end_of("shadows on planes");
  find_fragments();
  clock.end_of("fragments");
  FragmentShader(visible_.surfaces(), visible_.triangles(), input.shading).shade(fragments_);
  clock.end_of("shading");
  write_colors(window, layer);
  clock.end_of("writing");
  if (input.scene->with_depth) {
    centres_.begin(window.rect.width, window.rect.height);
    draw_occluders(input, window, centres_);
    visible_.draw(centres_);
    write_depth(input, window, layer);
    clock.end_of("depth");
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
    PlaneShadow reader(shadow, camera, input.scene->shadow_strength, input.plane_occlusion);
    for (int y = area.y0; y < area.y1; ++y) draw_shadow_row(reader, depth, window, area, y);
  }
}

void SoftwareLayer::draw_shadow_row(PlaneShadow& shadow, const DepthPlane& depth,
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

/// Each triangle that a pixel's samples show, once.
void SoftwareLayer::find_fragments() {
  fragments_.clear();
  for (int y = 0; y < samples_.rows(); ++y) {
    const auto [begin, end] = samples_.drawn_in(y);
    for (int x = begin; x < end; ++x) {
      const I4 triangle = samples_.block(x, y).triangle;
      const std::int32_t first = triangle[0];
      if (bits_of(triangle == first) == kAllSamples) {
        if (first != 0) add_fragment(x, y, first, kAllSamples);
        continue;
      }
      unsigned left = kAllSamples;
      for (int s = 0; s < 4; ++s) {
        if ((left >> s & 1U) == 0) continue;
        const unsigned alike = bits_of(triangle == triangle[s]);
        left &= ~alike;
        if (triangle[s] != 0) add_fragment(x, y, triangle[s], alike);
      }
    }
  }
}

void SoftwareLayer::add_fragment(int x, int y, std::int32_t triangle, unsigned samples) {
  Fragment& fragment = fragments_.emplace_back();
  fragment.x = static_cast<std::uint16_t>(x);
  fragment.y = static_cast<std::uint16_t>(y);
  fragment.triangle = triangle;
  fragment.samples = static_cast<std::uint8_t>(samples);
}

/// The mean of each pixel's samples, rounded to nearest.
void SoftwareLayer::write_colors(const Window& window, Layer& layer) const {
  const Layer::Rect& rect = window.rect;
  const auto width = static_cast<std::size_t>(rect.width);
  auto next = fragments_.begin();
  for (int y = 0; y < rect.height; ++y) {
    std::uint8_t* row = &layer.rgba.pixels[4 * (static_cast<std::size_t>(rect.y + y) *
                                                    static_cast<std::size_t>(window.picture_width) +
                                                static_cast<std::size_t>(rect.x))];
    const std::uint32_t* shadow = &shadow_alpha_[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < rect.width; ++x) {
      const bool object = next != fragments_.end() && next->y == y && next->x == x;
      if (!object && shadow[x] == 0) continue;
      std::uint8_t* rgba = &row[4 * static_cast<std::size_t>(x)];
      if (object && next->samples == kAllSamples && next->alpha != 0) {
        std::ranges::copy(next->color, rgba);
        rgba[3] = next->alpha;
        ++next;
        continue;
      }
      if (!object && shadow[x] == (shadow[x] & 0xFFU) * 0x01010101U) {
        rgba[3] = static_cast<std::uint8_t>(shadow[x] & 0xFFU);
        continue;
      }
      const auto first = next;
      while (next != fragments_.end() && next->y == y && next->x == x) ++next;
      write_mean({first, next}, shadow[x], rgba);
    }
  }
}

/// Samples that show nothing, or what the depth image hides, show the shadow.
void SoftwareLayer::write_mean(std::span<const Fragment> fragments, std::uint32_t shadow,
                               std::uint8_t* rgba) {
  std::array<int, 4> sum{};
  unsigned bare = kAllSamples;
  for (const Fragment& fragment : fragments) {
    const int samples = std::popcount(fragment.samples);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += samples * fragment.color[c];
    sum[3] += samples * fragment.alpha;
    if (fragment.alpha != 0) bare &= ~static_cast<unsigned>(fragment.samples);
  }
  for (int s = 0; s < 4; ++s) {
    if ((bare >> s & 1U) != 0) sum[3] += static_cast<int>((shadow >> (8 * s)) & 0xFFU);
  }
  for (std::size_t c = 0; c < 4; ++c) rgba[c] = static_cast<std::uint8_t>((sum[c] + 2) / 4);
}

void SoftwareLayer::write_depth(const SoftwareInput& input, const Window& window,
                                Layer& layer) const {
  const glm::vec2 depth = depth_coefficients(*input.camera);
  const DepthOcclusion& occlusion = input.shading.occlusion;
  const Layer::Rect& rect = window.rect;
  LaneInt columns{};
  LaneInt rows{};
  Lane visible;
  constexpr int kStep = static_cast<int>(kLanes);
  for (int y = 0; y < rect.height; ++y) {
    float* row = &layer.depth.pixels[static_cast<std::size_t>(rect.y + y) *
                                         static_cast<std::size_t>(window.picture_width) +
                                     static_cast<std::size_t>(rect.x)];
    rows.fill(rect.y + y);
    for (int first = 0; first < rect.width; first += kStep) {
      const int count = std::min(kStep, rect.width - first);
      Lane z{};
      bool any = false;
      for (int i = 0; i < count; ++i) {
        const int x = first + i;
        const auto lane = static_cast<std::size_t>(i);
        columns[lane] = rect.x + x;
        const SampleGrid::Block& block = centres_.block(x / 4, y);
        if (block.triangle[x % 4] == 0) continue;
        z[lane] = depth.y / (block.depth[x % 4] - depth.x);
        any = true;
      }
      if (!any) continue;
      if (occlusion.depth != nullptr) {
        constexpr float kSeen = 0.5F;
        find_visibility(occlusion, columns, rows, z, visible);
        for (std::size_t i = 0; i < kLanes; ++i) z[i] = visible[i] < kSeen ? 0.0F : z[i];
      }
      std::copy_n(z.begin(), count, row + first);
    }
  }
}

}  // namespace planecast::render
