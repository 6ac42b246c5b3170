#include "render/software/footprints.h"

#include <algorithm>
#include <cmath>

namespace planecast::render {
namespace {

constexpr float kMaxTaps = 8.0F;
/// Where a footprint is not finite, as beside the edge of a triangle that is seen edge-on.
constexpr float kNoFootprint = 1e10F;

/// sRGB decoding of a filtered byte value.
class DecodeTable {
 public:
  DecodeTable() {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const float c = static_cast<float>(i) / static_cast<float>(table_.size() - 1);
      table_[i] = c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
    }
  }
  const float* values() const { return table_.data(); }
  static constexpr int kLast = 255 * 16;

 private:
  std::array<float, kLast + 1> table_{};
};

const DecodeTable kDecoded;

}  // namespace

struct alignas(64) TapLanes {
  Lane u, v, axis_u, axis_v, level;
  LaneInt taps;
};

// Not in the namespace above, since what is compiled for several instruction sets has a name that
// others see.
void transform_footprints(const FootprintLanes& points, const glm::mat3& transform,
                          FootprintLanes& out);
void find_taps(const FootprintLanes& at, glm::vec2 size, TapLanes& out);
void find_levels(const FootprintLanes& at, glm::vec2 size, Lane& level);
void find_entries(const float* values, LaneInt& entries);

PLANECAST_WIDE void transform_footprints(const FootprintLanes& p, const glm::mat3& transform,
                                         FootprintLanes& out) {
  const float a = transform[0][0];
  const float b = transform[1][0];
  const float c = transform[2][0];
  const float d = transform[0][1];
  const float e = transform[1][1];
  const float f = transform[2][1];
  FootprintLanes found;  // that nothing else refers to what is written makes vectors possible
  for (std::size_t i = 0; i < kLanes; ++i) {
    found.u[i] = a * p.u[i] + b * p.v[i] + c;
    found.v[i] = d * p.u[i] + e * p.v[i] + f;
    found.u_across[i] = a * p.u_across[i] + b * p.v_across[i];
    found.v_across[i] = d * p.u_across[i] + e * p.v_across[i];
    found.u_down[i] = a * p.u_down[i] + b * p.v_down[i];
    found.v_down[i] = d * p.u_down[i] + e * p.v_down[i];
  }
  out = found;
}

PLANECAST_WIDE void find_taps(const FootprintLanes& at, glm::vec2 size, TapLanes& out) {
  const float width = size.x;
  const float height = size.y;
  TapLanes found;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float across_u = at.u_across[i] * width;
    const float across_v = at.v_across[i] * height;
    const float down_u = at.u_down[i] * width;
    const float down_v = at.v_down[i] * height;
    const float across2 = across_u * across_u + across_v * across_v;
    const float down2 = down_u * down_u + down_v * down_v;
    const bool along_row = across2 > down2;
    const float long2 = along_row ? across2 : down2;
    const float short2 = along_row ? down2 : across2;
    const bool known = long2 < kNoFootprint;
    const float stretch = std::sqrt(known ? long2 / larger(short2, 1.0F) : 1.0F);
    const float taps = smaller(larger(std::ceil(stretch), 1.0F), kMaxTaps);
    const float tap_long2 = long2 / (taps * taps);
    found.u[i] = known ? at.u[i] : 0.5F;
    found.v[i] = known ? at.v[i] : 0.5F;
    const float axis_u = along_row ? at.u_across[i] : at.u_down[i];
    const float axis_v = along_row ? at.v_across[i] : at.v_down[i];
    found.axis_u[i] = known ? axis_u : 0.0F;
    found.axis_v[i] = known ? axis_v : 0.0F;
    constexpr float kSmallestLevel = 16.0F;
    found.level[i] = known ? 0.5F * fast_log2(larger(tap_long2, 1.0F)) : kSmallestLevel;
    found.taps[i] = static_cast<std::int32_t>(taps);
  }
  out = found;
}

PLANECAST_WIDE void find_entries(const float* values, LaneInt& entries) {
  constexpr auto kScale = static_cast<float>(DecodeTable::kLast);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float limited = smaller(larger(values[i], 0.0F), 1.0F);
    entries[i] = static_cast<std::int32_t>(limited * kScale + 0.5F);
  }
}

/// Encoded values become linear; whole lanes, as reads come.
void decode_values(float* values, std::size_t count) {
  LaneInt entries;
  Lane decoded;
  for (std::size_t first = 0; first < count; first += kLanes) {
    find_entries(values + first, entries);
    pick(kDecoded.values(), entries, decoded);
    std::ranges::copy(decoded, values + first);
  }
}

PLANECAST_WIDE void find_levels(const FootprintLanes& at, glm::vec2 size, Lane& level) {
  const float width = size.x;
  const float height = size.y;
  Lane found;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float across_u = std::abs(at.u_across[i]) * width;
    const float across_v = std::abs(at.v_across[i]) * height;
    const float down_u = std::abs(at.u_down[i]) * width;
    const float down_v = std::abs(at.v_down[i]) * height;
    const float longest = larger(larger(across_u, across_v), larger(down_u, down_v));
    found[i] = fast_log2(smaller(larger(longest, 1e-6F), 1e6F));
  }
  level = found;
}

void place_trilinear(const FootprintLanes& points, const glm::mat3& transform, glm::vec2 size,
                     TextureReads& reads) {
  FootprintLanes at;
  transform_footprints(points, transform, at);
  Lane level;
  find_levels(at, size, level);
  std::ranges::copy(at.u, reads.u.begin());
  std::ranges::copy(at.v, reads.v.begin());
  std::ranges::copy(level, reads.level.begin());
  reads.count = kLanes;
}

StretchedTaps place_stretched(const FootprintLanes& points, std::size_t count,
                              const glm::mat3& transform, glm::vec2 size, TextureReads& reads) {
  FootprintLanes at;
  transform_footprints(points, transform, at);
  TapLanes lanes;
  find_taps(at, size, lanes);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto taps = static_cast<float>(lanes.taps[i]);
    const float step = 1.0F / taps;
    float along = 0.5F * step - 0.5F;
    for (std::int32_t tap = 0; tap < lanes.taps[i]; ++tap, ++next) {
      reads.u[next] = lanes.u[i] + lanes.axis_u[i] * along;
      reads.v[next] = lanes.v[i] + lanes.axis_v[i] * along;
      reads.level[next] = lanes.level[i];
      along += step;
    }
  }
  reads.count = next;
  return {lanes.taps};
}

void gather_stretched(const StretchedTaps& taps, std::size_t count, bool decode,
                      TextureReads& reads, Lane& red, Lane& green, Lane& blue) {
  if (decode) {
    for (auto* channel : {&reads.red, &reads.green, &reads.blue}) {
      decode_values(channel->data(), reads.count);
    }
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    float r = 0.0F;
    float g = 0.0F;
    float b = 0.0F;
    for (std::int32_t tap = 0; tap < taps.of_lane[i]; ++tap, ++next) {
      r += reads.red[next];
      g += reads.green[next];
      b += reads.blue[next];
    }
    const float share = 1.0F / static_cast<float>(taps.of_lane[i]);
    red[i] = r * share;
    green[i] = g * share;
    blue[i] = b * share;
  }
}

}  // namespace planecast::render
