#include "render/software/sample_grid.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace planecast::render {
namespace {

constexpr int kSubpixel = 256;
/// Triangles of fewer pixels a side have edge functions of 32 bits: 2 (128 * 256)^2 < 2^31, and the
/// last step leads one block beyond.
constexpr int kLargestNarrow = 96 * kSubpixel;

int floor_to_pixel(std::int32_t value) { return value >> 8; }

/// Samples exactly on an edge belong to the triangle that has it as its left or top edge.
bool owns_edge(std::int64_t dx, std::int64_t dy) { return dy < 0 || (dy == 0 && dx > 0); }

}  // namespace

ScreenVertex snapped(float u, float v, float depth, float inverse_w) {
  // Anything farther off, or no number, is of no triangle that is drawn rightly anyway.
  constexpr float kMost = 4e6F;
  const auto fixed = [](float pixels) {
    const float value = std::floor((pixels + 0.5F) * static_cast<float>(kSubpixel) + 0.5F);
    return value > -kMost && value < kMost ? static_cast<std::int32_t>(value) : 0;
  };
  return {fixed(u), fixed(v), depth, inverse_w};
}

SampleGrid::SampleGrid(Pattern pattern)
    : block_width_(pattern == Pattern::kFourSamples ? 1 : 4),
      lane_x_(pattern == Pattern::kFourSamples ? I4{96, 224, 32, 160} : I4{128, 384, 640, 896}),
      lane_y_(pattern == Pattern::kFourSamples ? I4{32, 96, 160, 224} : I4{128, 128, 128, 128}) {}

void SampleGrid::begin(int width, int height) {
  columns_ = (width + block_width_ - 1) / block_width_;
  rows_ = height;
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  blocks_.assign(count, Block{});
  marks_.assign(count, 0);
  drawn_.assign(static_cast<std::size_t>(rows_), {columns_, 0});
}

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

/// Calls visit(block index, coverage, x, y) for each block with a covered sample.
template <typename Lanes, typename Visit>
void SampleGrid::cover(const std::array<ScreenVertex, 3>& v, const Area& area,
                       const Visit& visit) const {
  using Int = std::conditional_t<std::is_same_v<Lanes, I4>, std::int32_t, std::int64_t>;
  const Lanes lane_x = __builtin_convertvector(lane_x_, Lanes);
  const Lanes lane_y = __builtin_convertvector(lane_y_, Lanes);
  const Int first_x = static_cast<Int>(area.x0) * block_width_ * kSubpixel;
  const Int first_y = static_cast<Int>(area.y0) * kSubpixel;
  std::array<Lanes, 3> row;
  std::array<Lanes, 3> step;
  std::array<Lanes, 3> down;
  for (std::size_t i = 0; i < 3; ++i) {
    const ScreenVertex& from = v[i];
    const ScreenVertex& to = v[(i + 1) % 3];
    const Int dx = static_cast<Int>(to.x) - from.x;
    const Int dy = static_cast<Int>(to.y) - from.y;
    const Int not_mine = owns_edge(dx, dy) ? 0 : 1;
    row[i] = (lane_y + (first_y - from.y)) * dx - (lane_x + (first_x - from.x)) * dy - not_mine;
    step[i] = Lanes{} - dy * block_width_ * kSubpixel;
    down[i] = Lanes{} + dx * kSubpixel;
  }
  for (int y = area.y0; y < area.y1; ++y) {
    std::array<Lanes, 3> edge = row;
    bool entered = false;
    std::size_t at = index(area.x0, y);
    for (int x = area.x0; x < area.x1; ++x, ++at) {
      // Large triangles are mostly inside: several blocks are looked at together.
      constexpr int kSeveral = 16;
      if (std::is_same_v<Lanes, L4> && (x - area.x0) % kSeveral == 0 && x + kSeveral <= area.x1) {
        std::array<Lanes, 3> last = edge;
        for (std::size_t i = 0; i < 3; ++i) last[i] += step[i] * (kSeveral - 1);
        const Cover between = cover_between(edge, last);
        if (between != Cover::kSome) {
          constexpr I4 kWhole = {-1, -1, -1, -1};
          for (int k = 0; between == Cover::kAll && k < kSeveral; ++k) {
            visit(at + static_cast<std::size_t>(k), kWhole, x + k, y);
          }
          for (std::size_t i = 0; i < 3; ++i) edge[i] = last[i] + step[i];
          x += kSeveral - 1;
          at += kSeveral - 1;
          continue;
        }
      }
      const Lanes inside = (edge[0] | edge[1] | edge[2]) >= 0;
      const I4 covered = __builtin_convertvector(inside, I4);
      if (bits_of(covered) != 0) {
        visit(at, covered, x, y);
        entered = true;
      } else if (entered && left_behind(edge, step)) {
        break;
      }
      for (std::size_t i = 0; i < 3; ++i) edge[i] += step[i];
    }
    for (std::size_t i = 0; i < 3; ++i) row[i] += down[i];
  }
}

template <typename Visit>
void SampleGrid::cover_any(std::array<ScreenVertex, 3> v, const Visit& visit) const {
  const std::int64_t area2 =
      (static_cast<std::int64_t>(v[1].x) - v[0].x) * (static_cast<std::int64_t>(v[2].y) - v[0].y) -
      (static_cast<std::int64_t>(v[2].x) - v[0].x) * (static_cast<std::int64_t>(v[1].y) - v[0].y);
  if (area2 == 0) return;
  if (area2 < 0) std::swap(v[1], v[2]);
  const auto [left, right] = std::minmax({v[0].x, v[1].x, v[2].x});
  const auto [top, bottom] = std::minmax({v[0].y, v[1].y, v[2].y});
  Area area;
  area.x0 = std::max(floor_to_pixel(left) / block_width_, 0);
  area.y0 = std::max(floor_to_pixel(top), 0);
  area.x1 = std::min(floor_to_pixel(right) / block_width_ + 1, columns_);
  area.y1 = std::min(floor_to_pixel(bottom) + 1, rows_);
  if (left >= kSubpixel * block_width_ * columns_ || right < 0 || area.y0 >= area.y1) return;
  if (right - left < kLargestNarrow && bottom - top < kLargestNarrow) {
    cover<I4>(v, area, visit);
  } else {
    cover<L4>(v, area, visit);
  }
}

void SampleGrid::draw(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                      std::int32_t number) {
  const double abx = b.x - a.x;
  const double aby = b.y - a.y;
  const double acx = c.x - a.x;
  const double acy = c.y - a.y;
  const double area2 = abx * acy - acx * aby;
  if (area2 == 0.0) return;
  const double ab = static_cast<double>(b.depth) - static_cast<double>(a.depth);
  const double ac = static_cast<double>(c.depth) - static_cast<double>(a.depth);
  const auto slope_x = static_cast<float>((ab * acy - ac * aby) / area2);
  const auto slope_y = static_cast<float>((ac * abx - ab * acx) / area2);
  const F4 lane_x = __builtin_convertvector(lane_x_ - a.x, F4);
  const F4 lane_y = __builtin_convertvector(lane_y_ - a.y, F4);
  const I4 numbers = {number, number, number, number};
  cover_any({a, b, c}, [&](std::size_t at, const I4& covered, int x, int y) {
    const F4 dx = lane_x + static_cast<float>(x * block_width_ * kSubpixel);
    const F4 dy = lane_y + static_cast<float>(y * kSubpixel);
    const F4 depth = a.depth + slope_x * dx + slope_y * dy;
    Block& block = blocks_[at];
    const I4 nearer = covered & (depth > block.depth);
    block.depth = nearer ? depth : block.depth;
    block.triangle = nearer ? numbers : block.triangle;
    auto& [first, end] = drawn_[static_cast<std::size_t>(y)];
    first = std::min(first, x);
    end = std::max(end, x + 1);
  });
}

SampleGrid::Area SampleGrid::mark(const std::vector<std::vector<glm::vec2>>& rings) {
  Area area{columns_, rows_, 0, 0};
  for (const auto& ring : rings) {
    for (std::size_t i = 2; i < ring.size(); ++i) {
      const auto corner = [&](std::size_t k) { return snapped(ring[k].x, ring[k].y, 0.0F, 0.0F); };
      cover_any({corner(0), corner(i - 1), corner(i)},
                [&](std::size_t at, const I4& covered, int x, int y) {
                  marks_[at] ^= static_cast<std::uint8_t>(bits_of(covered));
                  area.x0 = std::min(area.x0, x);
                  area.y0 = std::min(area.y0, y);
                  area.x1 = std::max(area.x1, x + 1);
                  area.y1 = std::max(area.y1, y + 1);
                });
    }
  }
  return area;
}

F4 SampleGrid::plane_depth(int x, int y, const DepthPlane& plane) const {
  constexpr float kPixel = 1.0F / static_cast<float>(kSubpixel);
  const F4 u = __builtin_convertvector(lane_x_ + x * block_width_ * kSubpixel, F4) * kPixel - 0.5F;
  const F4 v = __builtin_convertvector(lane_y_ + y * kSubpixel, F4) * kPixel - 0.5F;
  return plane.x * u + plane.y * v + plane.z;
}

void SampleGrid::fill_marked(const Area& area, const DepthPlane& plane) {
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      std::uint8_t& mark = marks_[index(x, y)];
      if (mark == 0) continue;
      const I4 marked = (I4{1, 2, 4, 8} & static_cast<std::int32_t>(mark)) != 0;
      mark = 0;
      const F4 depth = plane_depth(x, y, plane);
      Block& block = blocks_[index(x, y)];
      const I4 nearer = marked & (depth > block.depth);
      block.depth = nearer ? depth : block.depth;
      block.triangle = nearer ? I4{} : block.triangle;
    }
  }
}

unsigned SampleGrid::take_marks(int x, int y, const DepthPlane& plane) {
  std::uint8_t& mark = marks_[index(x, y)];
  if (mark == 0) return 0;
  const unsigned found = mark & bits_of(plane_depth(x, y, plane) > blocks_[index(x, y)].depth);
  mark = 0;
  return found;
}

}  // namespace planecast::render
