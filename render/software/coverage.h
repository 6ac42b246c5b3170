#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "render/software/lanes.h"

namespace planecast::render {

/// A vertex on the screen: pixels in 1/256, relative to the window's corner, the centre of the
/// first pixel being (128, 128).
struct ScreenVertex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  float depth = 0.0F;      ///< reversed for cameras: 1 near, 0 far
  float inverse_w = 0.0F;  ///< 1 / depth along the optical axis
};

inline constexpr int kSubpixel = 256;

/// Snaps pixels relative to the window's corner (pixel centres at integers).
inline ScreenVertex snapped(float u, float v, float depth, float inverse_w) {
  // Anything farther off, or no number, is of no triangle that is drawn rightly anyway.
  constexpr float kMost = 4e6F;
  const auto fixed = [](float pixels) {
    const float value = std::floor((pixels + 0.5F) * static_cast<float>(kSubpixel) + 0.5F);
    return value > -kMost && value < kMost ? static_cast<std::int32_t>(value) : 0;
  };
  return {fixed(u), fixed(v), depth, inverse_w};
}

/// Where the four samples of a block are.
struct SamplePattern {
  int block_width = 1;  ///< pixels
  I4 lane_x{};          ///< of each sample from the block's first pixel's corner, 1/256 pixel
  I4 lane_y{};

  /// The four samples of a pixel: the standard pattern of 4x multisampling.
  static SamplePattern four_samples() { return {1, I4{96, 224, 32, 160}, I4{32, 96, 160, 224}}; }
  /// The centres of four pixels in a row.
  static SamplePattern pixel_centres() {
    return {4, I4{128, 384, 640, 896}, I4{128, 128, 128, 128}};
  }
};

/// Blocks: columns and rows, the upper ones excluded.
struct BlockArea {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Something linear over a triangle, at the samples of blocks.
class LinearValue {
 public:
  /// By the triangle's first corner and two edges from it; see slopes().
  LinearValue(const SamplePattern& pattern, const ScreenVertex& at, float value, float slope_x,
              float slope_y)
      : dx_(__builtin_convertvector(pattern.lane_x - at.x, F4)),
        dy_(__builtin_convertvector(pattern.lane_y - at.y, F4)),
        width_(pattern.block_width * kSubpixel),
        value_(value),
        slope_x_(slope_x),
        slope_y_(slope_y) {}

  F4 at(int x, int y) const {
    const F4 dx = dx_ + static_cast<float>(x * width_);
    const F4 dy = dy_ + static_cast<float>(y * kSubpixel);
    return value_ + slope_x_ * dx + slope_y_ * dy;
  }

 private:
  F4 dx_, dy_;
  int width_;
  float value_, slope_x_, slope_y_;
};

/// Change of the corners' depths by 1/256 pixel to the right and down; nothing for a triangle
/// without area.
struct DepthSlopes {
  bool any = false;
  float x = 0.0F;
  float y = 0.0F;
};

inline DepthSlopes depth_slopes(const ScreenVertex& a, const ScreenVertex& b,
                                const ScreenVertex& c) {
  const double abx = b.x - a.x;
  const double aby = b.y - a.y;
  const double acx = c.x - a.x;
  const double acy = c.y - a.y;
  const double area2 = abx * acy - acx * aby;
  if (area2 == 0.0) return {};
  const double ab = static_cast<double>(b.depth) - static_cast<double>(a.depth);
  const double ac = static_cast<double>(c.depth) - static_cast<double>(a.depth);
  return {true, static_cast<float>((ab * acy - ac * aby) / area2),
          static_cast<float>((ac * abx - ab * acx) / area2)};
}

namespace coverage {

/// Triangles of fewer pixels a side have edge functions of 32 bits: 2 (128 * 256)^2 < 2^31, and the
/// last step leads one block beyond.
inline constexpr int kLargestNarrow = 96 * kSubpixel;

inline int floor_to_pixel(std::int32_t value) { return value >> 8; }

/// Samples exactly on an edge belong to the triangle that has it as its left or top edge.
inline bool owns_edge(std::int64_t dx, std::int64_t dy) { return dy < 0 || (dy == 0 && dx > 0); }

/// Whether no block further on can be inside: all samples are outside of an edge, ever farther.
/// That a block has none inside says nothing, as slivers pass between samples.
template <typename Lanes>
bool left_behind(const std::array<Lanes, 3>& edge, const std::array<Lanes, 3>& step) {
  for (std::size_t i = 0; i < 3; ++i) {
    const I4 outside = __builtin_convertvector(edge[i] < 0, I4);
    if (step[i][0] <= 0 && bits_of(outside) == 15U) return true;
  }
  return false;
}

enum class Cover { kNone, kSome, kAll };

/// Of blocks in a row, given the edge functions at the first and the last: between them they are
/// linear.
template <typename Lanes>
Cover cover_between(const std::array<Lanes, 3>& first, const std::array<Lanes, 3>& last) {
  bool all = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const I4 either = __builtin_convertvector((first[i] & last[i]) < 0, I4);
    if (bits_of(either) == 15U) return Cover::kNone;
    const I4 any = __builtin_convertvector((first[i] | last[i]) < 0, I4);
    all = all && bits_of(any) == 0;
  }
  return all ? Cover::kAll : Cover::kSome;
}

/// The edge functions of a triangle at the samples of a block, and how they change.
template <typename Lanes>
struct Edges {
  std::array<Lanes, 3> row;
  std::array<Lanes, 3> step;
  std::array<Lanes, 3> down;

  Edges(const std::array<ScreenVertex, 3>& v, const SamplePattern& pattern, const BlockArea& area) {
    using Int = std::conditional_t<std::is_same_v<Lanes, I4>, std::int32_t, std::int64_t>;
    const Lanes lane_x = __builtin_convertvector(pattern.lane_x, Lanes);
    const Lanes lane_y = __builtin_convertvector(pattern.lane_y, Lanes);
    const Int first_x = static_cast<Int>(area.x0) * pattern.block_width * kSubpixel;
    const Int first_y = static_cast<Int>(area.y0) * kSubpixel;
    for (std::size_t i = 0; i < 3; ++i) {
      const ScreenVertex& from = v[i];
      const ScreenVertex& to = v[(i + 1) % 3];
      const Int dx = static_cast<Int>(to.x) - from.x;
      const Int dy = static_cast<Int>(to.y) - from.y;
      const Int not_mine = owns_edge(dx, dy) ? 0 : 1;
      row[i] = (lane_y + (first_y - from.y)) * dx - (lane_x + (first_x - from.x)) * dy - not_mine;
      step[i] = Lanes{} - dy * pattern.block_width * kSubpixel;
      down[i] = Lanes{} + dx * kSubpixel;
    }
  }
};

template <typename Lanes, typename Visit>
void cover(const std::array<ScreenVertex, 3>& v, const SamplePattern& pattern,
           const BlockArea& area, const Visit& visit) {
  Edges<Lanes> edges(v, pattern, area);
  for (int y = area.y0; y < area.y1; ++y) {
    std::array<Lanes, 3> edge = edges.row;
    bool entered = false;
    for (int x = area.x0; x < area.x1; ++x) {
      // Large triangles are mostly inside: several blocks are looked at together.
      constexpr int kSeveral = 16;
      if (std::is_same_v<Lanes, L4> && (x - area.x0) % kSeveral == 0 && x + kSeveral <= area.x1) {
        std::array<Lanes, 3> last = edge;
        for (std::size_t i = 0; i < 3; ++i) last[i] += edges.step[i] * (kSeveral - 1);
        const Cover between = cover_between(edge, last);
        if (between != Cover::kSome) {
          constexpr I4 kWhole = {-1, -1, -1, -1};
          for (int k = 0; between == Cover::kAll && k < kSeveral; ++k) visit(x + k, y, kWhole);
          for (std::size_t i = 0; i < 3; ++i) edge[i] = last[i] + edges.step[i];
          x += kSeveral - 1;
          continue;
        }
      }
      const Lanes inside = (edge[0] | edge[1] | edge[2]) >= 0;
      const I4 covered = __builtin_convertvector(inside, I4);
      if (bits_of(covered) != 0) {
        visit(x, y, covered);
        entered = true;
      } else if (entered && left_behind(edge, edges.step)) {
        break;
      }
      for (std::size_t i = 0; i < 3; ++i) edge[i] += edges.step[i];
    }
    for (std::size_t i = 0; i < 3; ++i) edges.row[i] += edges.down[i];
  }
}

}  // namespace coverage

/// Calls visit(x, y, covered) for each block with a sample inside the triangle, whatever its
/// winding, of a target of `columns` x `rows` blocks. Triangles that share an edge share no sample
/// (top-left rule, exact integers).
template <typename Visit>
void visit_covered(std::array<ScreenVertex, 3> v, const SamplePattern& pattern, int columns,
                   int rows, const Visit& visit) {
  const std::int64_t area2 =
      (static_cast<std::int64_t>(v[1].x) - v[0].x) * (static_cast<std::int64_t>(v[2].y) - v[0].y) -
      (static_cast<std::int64_t>(v[2].x) - v[0].x) * (static_cast<std::int64_t>(v[1].y) - v[0].y);
  if (area2 == 0) return;
  if (area2 < 0) std::swap(v[1], v[2]);
  const auto [left, right] = std::minmax({v[0].x, v[1].x, v[2].x});
  const auto [top, bottom] = std::minmax({v[0].y, v[1].y, v[2].y});
  const int width = pattern.block_width;
  BlockArea area;
  area.x0 = std::max(coverage::floor_to_pixel(left) / width, 0);
  area.y0 = std::max(coverage::floor_to_pixel(top), 0);
  area.x1 = std::min(coverage::floor_to_pixel(right) / width + 1, columns);
  area.y1 = std::min(coverage::floor_to_pixel(bottom) + 1, rows);
  if (left >= kSubpixel * width * columns || right < 0 || area.y0 >= area.y1) return;
  if (right - left < coverage::kLargestNarrow && bottom - top < coverage::kLargestNarrow) {
    coverage::cover<I4>(v, pattern, area, visit);
  } else {
    coverage::cover<L4>(v, pattern, area, visit);
  }
}

}  // namespace planecast::render
