#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "render/scene.h"
#include "render/software/coverage.h"
#include "render/software/lanes.h"

namespace planecast::render {

/// Depth on the screen: at.x * u + at.y * v + at.z for pixel (u, v) of the window.
using DepthPlane = glm::vec3;

/// Depth and the nearest triangle at the samples of a window. Samples lie in blocks of four: the
/// four samples of a pixel (the standard pattern of 4x multisampling) or the centres of four pixels
/// in a row. Triangles that share an edge share no sample (top-left rule, exact integers).
class SampleGrid {
 public:
  enum class Pattern { kFourSamples, kPixelCentres };
  /// Samples of one block. `triangle` is 0 where there is none.
  struct Block {
    F4 depth;
    I4 triangle;
  };
  using Area = BlockArea;  ///< touched by a polygon

  explicit SampleGrid(Pattern pattern);

  /// Clears to nothing, farthest away.
  void begin(int width, int height);
  /// Nearest wins; `number` > 0. Both windings; `Area` limits of the window are kept.
  void draw(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
            std::int32_t number);
  /// Marks what rings of pixels enclose by the even-odd rule. Rings must lie within the window or
  /// its border: see clip_to_window(). Call take_marks() before the next.
  Area mark(const std::vector<std::vector<glm::vec2>>& rings);
  /// Depth of marked samples that are nearer than what is there; clears the marks.
  void fill_marked(const Area& area, const DepthPlane& plane);
  /// Of marked samples those nearer than what is there, one bit a sample; clears the mark.
  unsigned take_marks(int x, int y, const DepthPlane& plane);

  const Block& block(int x, int y) const { return blocks_[index(x, y)]; }
  /// Columns of a row that draw() may have touched, the second excluded.
  std::pair<int, int> drawn_in(int y) const { return drawn_[static_cast<std::size_t>(y)]; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x);
  }
  F4 plane_depth(int x, int y, const DepthPlane& plane) const;
  template <typename Visit>
  void cover(const std::array<ScreenVertex, 3>& v, const Visit& visit) const;

  SamplePattern pattern_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::uint8_t> marks_;
  std::vector<std::pair<int, int>> drawn_;  ///< by row
};

}  // namespace planecast::render
