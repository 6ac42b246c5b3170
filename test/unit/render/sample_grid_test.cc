#include "render/software/sample_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>

namespace planecast::render {
namespace {

constexpr int kSide = 48;

int covered_samples(const SampleGrid& grid, std::int32_t number) {
  int count = 0;
  for (int y = 0; y < grid.rows(); ++y) {
    for (int x = 0; x < grid.columns(); ++x) {
      for (int s = 0; s < 4; ++s) count += grid.block(x, y).triangle[s] == number ? 1 : 0;
    }
  }
  return count;
}

/// Neighbours leave no gap and share no sample: a fan of slim triangles fills its square exactly.
/// In the larger square triangles are wide enough for the path that looks at many blocks together.
TEST(SampleGrid, TrianglesOfOneSurfaceCoverEachSampleOnce) {
  std::mt19937 random(7);
  for (const auto& [pattern, side] : {std::pair{SampleGrid::Pattern::kFourSamples, 48},
                                      {SampleGrid::Pattern::kPixelCentres, 48},
                                      {SampleGrid::Pattern::kFourSamples, 200},
                                      {SampleGrid::Pattern::kPixelCentres, 400}}) {
    const float end = static_cast<float>(side) - 0.5F;
    std::uniform_real_distribution<float> somewhere(0.2F * end, 0.8F * end);
    for (int round = 0; round < 20; ++round) {
      const glm::vec2 middle(somewhere(random), somewhere(random));
      const int slices = round % 2 == 0 ? 3 : 12;
      std::vector<glm::vec2> rim;
      for (int i = 0; i < 4 * slices; ++i) {
        const float t = static_cast<float>(i % slices) / static_cast<float>(slices);
        const std::array<glm::vec2, 5> corners = {
            glm::vec2(-0.5F), {end, -0.5F}, glm::vec2(end), {-0.5F, end}, glm::vec2(-0.5F)};
        const auto edge = static_cast<std::size_t>(i / slices);
        rim.push_back(glm::mix(corners[edge], corners[edge + 1], t));
      }
      int total = 0;
      SampleGrid grid(pattern);
      for (std::size_t i = 0; i < rim.size(); ++i) {
        const auto at = [](glm::vec2 p) { return snapped(p.x, p.y, 0.5F, 1.0F); };
        grid.begin(side, side);
        grid.draw(at(middle), at(rim[i]), at(rim[(i + 1) % rim.size()]), 1);
        total += covered_samples(grid, 1);
      }
      EXPECT_EQ(total, grid.columns() * grid.rows() * 4);
    }
  }
}

TEST(SampleGrid, TheNearestTriangleWinsWhateverTheOrder) {
  const auto corner = [](float u, float v, float depth) { return snapped(u, v, depth, 1.0F); };
  for (const bool near_first : {false, true}) {
    SampleGrid grid(SampleGrid::Pattern::kFourSamples);
    grid.begin(kSide, kSide);
    const auto near = [&] {
      grid.draw(corner(0, 0, 0.9F), corner(40, 0, 0.9F), corner(0, 40, 0.9F), 1);
    };
    const auto far = [&] {
      grid.draw(corner(0, 0, 0.2F), corner(0, 40, 0.2F), corner(40, 0, 0.2F), 2);
    };
    if (near_first) near();
    far();
    if (!near_first) near();
    EXPECT_EQ(covered_samples(grid, 2), 0);
    EXPECT_NEAR(covered_samples(grid, 1), 4 * 800, 30);
  }
}

TEST(SampleGrid, DepthIsExactAtTheSamples) {
  SampleGrid grid(SampleGrid::Pattern::kPixelCentres);
  grid.begin(kSide, kSide);
  const auto corner = [](float u, float v) {
    return snapped(u, v, 0.1F + 0.01F * u + 0.002F * v, 1.0F);
  };
  grid.draw(corner(2, 3), corner(45, 5), corner(7, 44), 1);
  EXPECT_NEAR(grid.block(2, 20).depth[3], 0.1F + 0.11F + 0.04F, 1e-6F);
}

/// A concave outline with a hole, wound either way.
TEST(SampleGrid, MarksAreEvenOdd) {
  std::vector<glm::vec2> outer = {{4, 4}, {40, 4}, {40, 40}, {22, 20}, {4, 40}};
  const std::vector<glm::vec2> hole = {{10, 8}, {16, 8}, {16, 14}, {10, 14}};
  for (int winding = 0; winding < 2; ++winding) {
    SampleGrid grid(SampleGrid::Pattern::kFourSamples);
    grid.begin(kSide, kSide);
    grid.mark({outer, hole});
    const DepthPlane near(0.0F, 0.0F, 0.5F);
    EXPECT_EQ(grid.take_marks(13, 11, near), 0U) << "in the hole";
    EXPECT_EQ(grid.take_marks(22, 35, near), 0U) << "in the notch";
    EXPECT_EQ(grid.take_marks(22, 10, near), 15U);
    EXPECT_EQ(grid.take_marks(22, 10, near), 0U) << "taken before";
    EXPECT_EQ(grid.take_marks(30, 10, DepthPlane(0.0F, 0.0F, -0.5F)), 0U) << "behind everything";
    std::ranges::reverse(outer);
  }
}

}  // namespace
}  // namespace planecast::render
