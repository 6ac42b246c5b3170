#include "render/software/environment_lanes.h"

#include <algorithm>
#include <cmath>

#include "render/software/lane_vec.h"

namespace planecast::render {

constexpr int kFaces = 6;

/// Places on the faces of a cube, 0..1 along their sides, in OpenGL's order and directions.
struct alignas(64) CubePlaces {
  LaneInt face;
  Lane s, t;
};

// Compiled for several instruction sets: names that others see.
void find_mirrored(const SurfaceLanes& lanes, const glm::vec3& eye, const glm::mat3& turn,
                   LaneVec3& mirrored, Lane& roughness);
void find_places(const LaneVec3& directions, CubePlaces& places);

PLANECAST_WIDE void find_mirrored(const SurfaceLanes& lanes, const glm::vec3& eye,
                                  const glm::mat3& turn, LaneVec3& mirrored, Lane& roughness) {
  const Vec from = vec(eye);
  const Vec row_x = {turn[0][0], turn[1][0], turn[2][0]};
  const Vec row_y = {turn[0][1], turn[1][1], turn[2][1]};
  const Vec row_z = {turn[0][2], turn[1][2], turn[2][2]};
  LaneVec3 found;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Vec n = load(lanes.shading, i);
    const Vec v = normalized(from - load(lanes.position, i));
    const Vec world = n * (2.0F * dot(n, v)) - v;
    store(found, i, {dot(row_x, world), dot(row_y, world), dot(row_z, world)});
    roughness[i] = smaller(larger(lanes.roughness[i], kSmallestRoughness), 1.0F);
  }
  mirrored = found;
}

PLANECAST_WIDE void find_places(const LaneVec3& directions, CubePlaces& places) {
  CubePlaces found;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Vec d = load(directions, i);
    const Vec a = {std::abs(d.x), std::abs(d.y), std::abs(d.z)};
    const bool along_x = (a.x >= a.y) & (a.x >= a.z);
    const bool along_y = !along_x & (a.y >= a.z);
    const float major = along_x ? d.x : (along_y ? d.y : d.z);
    const float sign = major > 0.0F ? 1.0F : -1.0F;
    const float longest = larger(std::abs(major), 1e-20F);
    const float s = along_x ? -sign * d.z : (along_y ? d.x : sign * d.x);
    const float t = along_y ? sign * d.z : -d.y;
    const float half = 0.5F / longest;
    found.s[i] = s * half + 0.5F;
    found.t[i] = t * half + 0.5F;
    const std::int32_t axis = along_x ? 0 : (along_y ? 2 : 4);
    found.face[i] = axis + (major > 0.0F ? 0 : 1);
  }
  places = found;
}

EnvironmentTexels::EnvironmentTexels(const Environment& environment)
    : levels_(std::min(environment.levels(), static_cast<int>(kMostLevels))) {
  for (int level = 0; level < levels_; ++level) {
    const int side = environment.side(level);
    first_[static_cast<std::size_t>(level)] = static_cast<std::int32_t>(texels_.size());
    side_[static_cast<std::size_t>(level)] = side;
    for (int face = 0; face < kFaces; ++face) {
      for (int y = -1; y <= side; ++y) {
        for (int x = -1; x <= side; ++x) {
          const glm::vec3 texel = environment.texel(level, face, x, y);
          texels_.push_back(F4{texel.x, texel.y, texel.z, 0.0F});
        }
      }
    }
  }
}

void EnvironmentTexels::read(const LaneVec3& directions, const Lane& level,
                             LaneVec3& radiance) const {
  CubePlaces places;
  find_places(directions, places);
  const auto blended = [&](std::size_t i, std::size_t at_level) {
    const std::int32_t side = side_[at_level];
    const std::int32_t width = side + 2;
    // The border is a texel, and a place is half a texel from its texel's centre.
    const auto axis = [side](float share) {
      const float place = share * static_cast<float>(side) + 0.5F;
      // What is no number becomes 0.
      return smaller(place > 0.0F ? place : 0.0F, static_cast<float>(side) + 0.999F);
    };
    const float x = axis(places.s[i]);
    const float y = axis(places.t[i]);
    const auto x0 = static_cast<std::int32_t>(x);
    const auto y0 = static_cast<std::int32_t>(y);
    const float fx = x - static_cast<float>(x0);
    const float fy = y - static_cast<float>(y0);
    const F4* at = &texels_[static_cast<std::size_t>(first_[at_level] +
                                                     (places.face[i] * width + y0) * width + x0)];
    const F4 top = at[0] + fx * (at[1] - at[0]);
    const F4 low = at[width] + fx * (at[width + 1] - at[width]);
    return top + fy * (low - top);
  };
  const auto last = static_cast<float>(levels_ - 1);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float place = smaller(level[i] > 0.0F ? level[i] : 0.0F, last);
    const auto finer = static_cast<std::size_t>(static_cast<std::int32_t>(place));
    const std::size_t coarser = std::min(finer + 1, static_cast<std::size_t>(levels_ - 1));
    const F4 near = blended(i, finer);
    const F4 found = near + (place - static_cast<float>(finer)) * (blended(i, coarser) - near);
    radiance.set(i, {found[0], found[1], found[2]});
  }
}

void find_reflections(SurfaceLanes& lanes, const glm::vec3& eye, const Reflections& reflections) {
  LaneVec3 mirrored;
  Lane level;
  find_mirrored(lanes, eye, reflections.environment_from_world, mirrored, level);
  const auto last = static_cast<float>(reflections.texels->levels() - 1);
  for (float& value : level) value *= last;
  reflections.texels->read(mirrored, level, lanes.reflected);
  for (Lane* channel : {&lanes.reflected.x, &lanes.reflected.y, &lanes.reflected.z}) {
    for (float& value : *channel) value *= reflections.gain;
  }
}

Reflections EnvironmentInMemory::reflections(const Light& light) {
  if (light.environment == nullptr) return {};
  if (light.environment != source_) {
    source_ = light.environment;
    texels_ = std::make_unique<EnvironmentTexels>(*source_);
  }
  return {texels_.get(), light.environment_from_world, light.environment_gain};
}

void EnvironmentInMemory::clear() {
  source_.reset();
  texels_.reset();
}

}  // namespace planecast::render
