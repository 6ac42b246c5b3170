#include "render/software/penumbra_map.h"

#include <algorithm>

#include "render/passes/catcher_plan.h"

namespace planecast::render {

/// A row of texels of the sun's map and the plane's depths along it: start + slope * column.
struct PlaneDepths {
  float start = 0.0F;
  float slope = 0.0F;
  float depth_m = 0.0F;  ///< of the map's depth range
};

// Compiled for several instruction sets: names that others see.
void add_row(const float* depths, int factor, int count, const PlaneDepths& plane, float* blocked,
             float* gap_m);
void halve_row(const float* upper, const float* lower, int count, float* out);

PLANECAST_WIDE void add_row(const float* __restrict depths, int factor, int count,
                            const PlaneDepths& plane, float* __restrict blocked,
                            float* __restrict gap_m) {
  const float start = plane.start;
  const float slope = plane.slope;
  const float depth_m = plane.depth_m;
  for (int k = 0; k < factor; ++k) {
    for (int i = 0; i < count; ++i) {
      const int column = i * factor + k;
      const float plane_depth = start + slope * static_cast<float>(column);
      const float depth = depths[column];
      const bool blocks = depth < smaller(plane_depth, 1.0F);
      blocked[i] += blocks ? 1.0F : 0.0F;
      gap_m[i] += blocks ? (plane_depth - depth) * depth_m : 0.0F;
    }
  }
}

PLANECAST_WIDE void halve_row(const float* __restrict upper, const float* __restrict lower,
                              int count, float* __restrict out) {
  for (int i = 0; i < count; ++i) {
    const int k = 2 * i;
    out[i] = 0.25F * ((upper[k] + upper[k + 1]) + (lower[k] + lower[k + 1]));
  }
}

void PenumbraMap::allot(int side) {
  PenumbraLevels& levels = levels_;
  if (levels.count > 0 && levels.side[0] == side + 2) return;
  levels.count = 0;
  std::int32_t total = 0;
  for (int s = side; s > 0; s /= 2) {
    const auto level = static_cast<std::size_t>(levels.count++);
    levels.first[level] = total;
    levels.side[level] = s + 2;
    total += (s + 2) * (s + 2);
  }
  levels.blocked.assign(static_cast<std::size_t>(total), 0.0F);
  levels.gap_m.assign(static_cast<std::size_t>(total), 0.0F);
}

void PenumbraMap::make(const SunMap& sun, const glm::vec4& plane) {
  const int factor = penumbra_factor(sun.size());
  const int side = sun.size() / factor;
  allot(side);
  const ShadowProjection& projection = sun.projection();
  const glm::vec4 p = glm::transpose(glm::inverse(projection.clip_from_world)) * plane;
  const float texel = 2.0F / static_cast<float>(sun.size());  // in clip space
  const auto row_of = [](const PenumbraLevels& levels, std::size_t level, int y) {
    return static_cast<std::size_t>(levels.first[level] + (y + 1) * levels.side[level] + 1);
  };
  const float share = 1.0F / static_cast<float>(factor * factor);
  for (int y = 0; y < side; ++y) {
    float* blocked = &levels_.blocked[row_of(levels_, 0, y)];
    float* gap_m = &levels_.gap_m[row_of(levels_, 0, y)];
    std::fill_n(blocked, side, 0.0F);
    std::fill_n(gap_m, side, 0.0F);
    for (int k = 0; k < factor; ++k) {
      const int row = y * factor + k;
      const float clip_y = (static_cast<float>(row) + 0.5F) * texel - 1.0F;
      const float clip_x = 0.5F * texel - 1.0F;
      const PlaneDepths along = {-(p.x * clip_x + p.y * clip_y + p.w) / p.z, -p.x * texel / p.z,
                                 projection.depth_m};
      add_row(sun.depths() + static_cast<std::ptrdiff_t>(row) * sun.size(), factor, side, along,
              blocked, gap_m);
    }
    std::transform(blocked, blocked + side, blocked, [&](float sum) { return share * sum; });
    std::transform(gap_m, gap_m + side, gap_m, [&](float sum) { return share * sum; });
  }
  for (std::size_t level = 1; level < static_cast<std::size_t>(levels_.count); ++level) {
    const int count = levels_.side[level] - 2;
    for (int y = 0; y < count; ++y) {
      for (std::vector<float>* values : {&levels_.blocked, &levels_.gap_m}) {
        float* data = values->data();
        halve_row(data + row_of(levels_, level - 1, 2 * y),
                  data + row_of(levels_, level - 1, 2 * y + 1), count,
                  data + row_of(levels_, level, y));
      }
    }
  }
}

}  // namespace planecast::render
