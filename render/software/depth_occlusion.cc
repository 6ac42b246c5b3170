#include "render/software/depth_occlusion.h"

#include <array>

namespace planecast::render {

PLANECAST_WIDE void find_visibility(const DepthOcclusion& occlusion, const LaneInt& x,
                                    const LaneInt& y, const Lane& z, Lane& visible) {
  struct Tap {
    std::int32_t x, y;
    float weight;
  };
  constexpr std::array<Tap, 5> kTaps = {
      {{0, 0, 0.4F}, {1, 0, 0.15F}, {-1, 0, 0.15F}, {0, 1, 0.15F}, {0, -1, 0.15F}}};
  const float* depth = occlusion.depth->pixels.data();
  const std::int32_t width = occlusion.depth->width;
  const std::int32_t last_x = width - 1;
  const std::int32_t last_y = occlusion.depth->height - 1;
  const float tolerance = occlusion.tolerance;
  Lane sum{};
  for (const Tap& tap : kTaps) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::int32_t right = x[i] + tap.x > 0 ? x[i] + tap.x : 0;
      const std::int32_t down = y[i] + tap.y > 0 ? y[i] + tap.y : 0;
      const std::int32_t column = right < last_x ? right : last_x;
      const std::int32_t row = down < last_y ? down : last_y;
      const float seen = depth[row * width + column];
      const float behind = (z[i] - seen) / (seen * tolerance + 1e-9F);
      const float visible_here = smaller(larger(1.0F - behind, 0.0F), 1.0F);
      sum[i] += tap.weight * (seen > 0.0F ? visible_here : 1.0F);
    }
  }
  visible = sum;
}

}  // namespace planecast::render
