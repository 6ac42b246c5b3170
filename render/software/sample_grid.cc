#include "render/software/sample_grid.h"

#include <algorithm>

namespace planecast::render {

SampleGrid::SampleGrid(Pattern pattern)
    : pattern_(pattern == Pattern::kFourSamples ? SamplePattern::four_samples()
                                                : SamplePattern::pixel_centres()) {}

void SampleGrid::begin(int width, int height) {
  columns_ = (width + pattern_.block_width - 1) / pattern_.block_width;
  rows_ = height;
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  blocks_.assign(count, Block{});
  marks_.assign(count, 0);
  drawn_.assign(static_cast<std::size_t>(rows_), {columns_, 0});
}

template <typename Visit>
void SampleGrid::cover(const std::array<ScreenVertex, 3>& v, const Visit& visit) const {
  visit_covered(v, pattern_, columns_, rows_,
                [&](int x, int y, const I4& covered) { visit(index(x, y), covered, x, y); });
}

void SampleGrid::draw(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                      std::int32_t number) {
  const DepthSlopes slopes = depth_slopes(a, b, c);
  if (!slopes.any) return;
  const LinearValue depth_at(pattern_, a, a.depth, slopes.x, slopes.y);
  const I4 numbers = {number, number, number, number};
  cover({a, b, c}, [&](std::size_t at, const I4& covered, int x, int y) {
    const F4 depth = depth_at.at(x, y);
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
      cover({corner(0), corner(i - 1), corner(i)},
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
  const F4 u =
      __builtin_convertvector(pattern_.lane_x + x * pattern_.block_width * kSubpixel, F4) * kPixel -
      0.5F;
  const F4 v = __builtin_convertvector(pattern_.lane_y + y * kSubpixel, F4) * kPixel - 0.5F;
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
