#include "render/environment.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <future>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace planecast::render {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kFaces = 6;
/// What half floats hold.
constexpr float kBrightest = 60000.0F;

/// Not normalised: the largest component is 1.
glm::vec3 face_direction(int face, float s, float t) {
  switch (face) {
    case 0:
      return {1.0F, -t, -s};
    case 1:
      return {-1.0F, -t, s};
    case 2:
      return {s, 1.0F, t};
    case 3:
      return {s, -1.0F, -t};
    case 4:
      return {s, -t, 1.0F};
    default:
      return {-s, -t, -1.0F};
  }
}

struct FacePlace {
  int face = 0;
  float s = 0.0F;
  float t = 0.0F;
};

FacePlace place_on_cube(const glm::vec3& d) {
  const glm::vec3 a = glm::abs(d);
  if (a.x >= a.y && a.x >= a.z) {
    return d.x > 0.0F ? FacePlace{0, -d.z / a.x, -d.y / a.x} : FacePlace{1, d.z / a.x, -d.y / a.x};
  }
  if (a.y >= a.z) {
    return d.y > 0.0F ? FacePlace{2, d.x / a.y, d.z / a.y} : FacePlace{3, d.x / a.y, -d.z / a.y};
  }
  return d.z > 0.0F ? FacePlace{4, d.x / a.z, -d.y / a.z} : FacePlace{5, -d.x / a.z, -d.y / a.z};
}

/// Calls visit(index, direction, share of the sphere) for each texel of a cube's face; shares of
/// all six sum to about 1.
template <typename Visit>
void for_each_texel_of_face(int face, int side, const Visit& visit) {
  std::size_t index = static_cast<std::size_t>(face) * static_cast<std::size_t>(side * side);
  const float texel = 2.0F / static_cast<float>(side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x, ++index) {
      const glm::vec3 d = face_direction(face, (static_cast<float>(x) + 0.5F) * texel - 1.0F,
                                         (static_cast<float>(y) + 0.5F) * texel - 1.0F);
      const float length2 = glm::dot(d, d);
      const float share = texel * texel / (length2 * std::sqrt(length2) * 4.0F * kPi);
      visit(index, d / std::sqrt(length2), share);
    }
  }
}

template <typename Visit>
void for_each_texel(int side, const Visit& visit) {
  for (int face = 0; face < kFaces; ++face) for_each_texel_of_face(face, side, visit);
}

/// The same with the faces shared out to threads.
template <typename Visit>
void for_each_texel(int side, int threads, const Visit& visit) {
  std::vector<std::future<void>> others;
  const int workers = std::clamp(threads, 1, kFaces);
  const auto work = [&](int worker) {
    for (int face = worker; face < kFaces; face += workers) {
      for_each_texel_of_face(face, side, visit);
    }
  };
  for (int worker = 1; worker < workers; ++worker) {
    others.push_back(std::async(std::launch::async, work, worker));
  }
  work(0);
}

glm::vec3 texel_at(const std::vector<glm::vec3>& cube, int side, const FacePlace& place) {
  const auto texel = [side](float coordinate) {
    const int at = static_cast<int>(0.5F * (coordinate + 1.0F) * static_cast<float>(side));
    return static_cast<std::size_t>(std::clamp(at, 0, side - 1));
  };
  const auto n = static_cast<std::size_t>(side);
  return cube[(static_cast<std::size_t>(place.face) * n + texel(place.t)) * n + texel(place.s)];
}

/// Between the four nearest texels of a face; past its border the outermost.
glm::vec3 blended_at(const std::vector<glm::vec3>& cube, int side, const FacePlace& place) {
  const auto last = static_cast<float>(side - 1);
  const auto n = static_cast<std::size_t>(side);
  const auto axis = [&](float coordinate) {
    return std::clamp(0.5F * (coordinate + 1.0F) * static_cast<float>(side) - 0.5F, 0.0F, last);
  };
  const float x = axis(place.s);
  const float y = axis(place.t);
  const auto x0 = static_cast<std::size_t>(x);
  const auto y0 = static_cast<std::size_t>(y);
  const std::size_t x1 = std::min(x0 + 1, n - 1);
  const std::size_t y1 = std::min(y0 + 1, n - 1);
  const glm::vec3* face = &cube[static_cast<std::size_t>(place.face) * n * n];
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  return glm::mix(glm::mix(face[y0 * n + x0], face[y0 * n + x1], fx),
                  glm::mix(face[y1 * n + x0], face[y1 * n + x1], fx), fy);
}

std::vector<glm::vec3> half_of(const std::vector<glm::vec3>& cube, int side) {
  const auto n = static_cast<std::size_t>(side);
  const std::size_t half = n / 2;
  std::vector<glm::vec3> result(kFaces * half * half);
  for (std::size_t face = 0; face < kFaces; ++face) {
    for (std::size_t y = 0; y < half; ++y) {
      for (std::size_t x = 0; x < half; ++x) {
        const glm::vec3* at = &cube[(face * n + 2 * y) * n + 2 * x];
        result[(face * half + y) * half + x] = 0.25F * (at[0] + at[1] + at[n] + at[n + 1]);
      }
    }
  }
  return result;
}

float usable(float value) { return value > 0.0F ? std::min(value, kBrightest) : 0.0F; }

/// Mean of the map's texels whose centres lie within the solid angle of each cube texel, or the
/// nearest where there is none.
std::vector<glm::vec3> cube_of(const ImageF& map, int side) {
  std::vector<glm::vec3> sum(static_cast<std::size_t>(kFaces * side * side), glm::vec3(0.0F));
  std::vector<float> weight(sum.size(), 0.0F);
  const auto n = static_cast<std::size_t>(side);
  const auto texel_of = [&](int x, int y) {
    const float* rgb =
        &map.pixels[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                         static_cast<std::size_t>(x))];
    return glm::vec3(usable(rgb[0]), usable(rgb[1]), usable(rgb[2]));
  };
  const glm::vec2 size(map.width, map.height);
  for (int y = 0; y < map.height; ++y) {
    const float row_weight =
        std::sin(kPi * (static_cast<float>(y) + 0.5F) / static_cast<float>(map.height));
    for (int x = 0; x < map.width; ++x) {
      const glm::vec2 centre = (glm::vec2(x, y) + 0.5F) / size;
      const FacePlace place = place_on_cube(equirectangular_direction(centre));
      const auto at = [&](float coordinate) {
        const int i = static_cast<int>(0.5F * (coordinate + 1.0F) * static_cast<float>(side));
        return static_cast<std::size_t>(std::clamp(i, 0, side - 1));
      };
      const std::size_t index =
          (static_cast<std::size_t>(place.face) * n + at(place.t)) * n + at(place.s);
      sum[index] += row_weight * texel_of(x, y);
      weight[index] += row_weight;
    }
  }
  for_each_texel(side, [&](std::size_t index, const glm::vec3& d, float) {
    if (weight[index] > 0.0F) {
      sum[index] /= weight[index];
      return;
    }
    const float u = 0.5F + std::atan2(d.x, -d.z) / (2.0F * kPi);
    const float v = std::acos(std::clamp(d.y, -1.0F, 1.0F)) / kPi;
    sum[index] = texel_of(std::clamp(static_cast<int>(u * size.x), 0, map.width - 1),
                          std::clamp(static_cast<int>(v * size.y), 0, map.height - 1));
  });
  return sum;
}

/// One direction of a lobe around +z.
struct LobeSample {
  glm::vec3 to_light{};
  float weight = 0.0F;
  int level = 0;  ///< of the pyramid: as coarse as the samples are far apart
};

/// GGX by importance: each sample as probable as its share, from a low-discrepancy sequence.
std::vector<LobeSample> lobe_of(float roughness, int count, int side, int levels) {
  const float alpha = roughness * roughness;
  const float a2 = alpha * alpha;
  const float texel_angle = 4.0F * kPi / static_cast<float>(kFaces * side * side);
  std::vector<LobeSample> lobe;
  for (int i = 0; i < count; ++i) {
    // Hammersley: evenly along one axis, van der Corput's sequence along the other.
    const float x = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    std::uint32_t bits = 0;
    for (std::uint32_t b = 0; b < 32; ++b)
      bits |= (static_cast<std::uint32_t>(i) >> b & 1U) << (31U - b);
    const float y = static_cast<float>(bits) * 0x1p-32F;
    const float cos2 = (1.0F - x) / (1.0F + (a2 - 1.0F) * x);
    const float cosine = std::sqrt(cos2);
    const float sine = std::sqrt(1.0F - cos2);
    const glm::vec3 h(sine * std::cos(2.0F * kPi * y), sine * std::sin(2.0F * kPi * y), cosine);
    const glm::vec3 l = 2.0F * cosine * h - glm::vec3(0, 0, 1);
    if (l.z <= 0.0F) continue;
    const float d = cos2 * (a2 - 1.0F) + 1.0F;
    const float density = a2 / (kPi * d * d) / 4.0F;
    const float sample_angle = 1.0F / (static_cast<float>(count) * density);
    const float level = 0.5F * std::log2(std::max(sample_angle / texel_angle, 1.0F));
    lobe.push_back({l, l.z, std::min(static_cast<int>(level + 0.5F), levels - 1)});
  }
  return lobe;
}

}  // namespace

glm::vec3 equirectangular_direction(glm::vec2 place) {
  const float around = 2.0F * kPi * (place.x - 0.5F);
  const float polar = kPi * place.y;
  return {std::sin(polar) * std::sin(around), std::cos(polar), -std::sin(polar) * std::cos(around)};
}

Environment::Environment(const ImageF& map, const EnvironmentOptions& options) : options_(options) {
  if (map.width < 1 || map.height < 1 || map.channels != 3) {
    throw std::invalid_argument("environment: an equirectangular map of three channels is needed");
  }
  options_.side =
      static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(options.side, 8))));
  pyramid_.push_back(cube_of(map, options_.side));
  for (int side = options_.side; side > 1; side /= 2) {
    pyramid_.push_back(half_of(pyramid_.back(), side));
  }
  cubes_.push_back(pyramid_.front());
  int count = 1;
  while (side(count) >= std::max(options_.smallest, 1)) ++count;
  const int levels = static_cast<int>(pyramid_.size());
  for (int level = 1; level < count; ++level) {
    const float roughness = static_cast<float>(level) / static_cast<float>(count - 1);
    const auto lobe = lobe_of(roughness, options_.samples, options_.side, levels);
    const auto n = static_cast<std::size_t>(side(level));
    std::vector<glm::vec3>& cube = cubes_.emplace_back(kFaces * n * n);
    for_each_texel(
        side(level), options_.threads, [&](std::size_t index, const glm::vec3& normal, float) {
          const glm::vec3 helper =
              std::abs(normal.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
          const glm::vec3 a = glm::normalize(glm::cross(helper, normal));
          const glm::vec3 b = glm::cross(normal, a);
          glm::vec3 sum(0.0F);
          float weight = 0.0F;
          for (const LobeSample& sample : lobe) {
            const glm::vec3 l =
                sample.to_light.x * a + sample.to_light.y * b + sample.to_light.z * normal;
            sum += sample.weight * blended_at(pyramid_[static_cast<std::size_t>(sample.level)],
                                              side(sample.level), place_on_cube(l));
            weight += sample.weight;
          }
          cube[index] = sum / weight;
        });
  }
}

glm::vec3 Environment::texel(int level, int face, int x, int y) const {
  const int side = this->side(level);
  const auto coordinate = [side](int at) {
    return 2.0F * (static_cast<float>(at) + 0.5F) / static_cast<float>(side) - 1.0F;
  };
  return texel_at(texels(level), side,
                  place_on_cube(face_direction(face, coordinate(x), coordinate(y))));
}

glm::vec3 Environment::radiance(const glm::vec3& direction, float roughness) const {
  const float level = std::clamp(roughness, 0.0F, 1.0F) * static_cast<float>(levels() - 1);
  const int finer = std::min(static_cast<int>(level), levels() - 1);
  const int coarser = std::min(finer + 1, levels() - 1);
  const FacePlace place = place_on_cube(direction);
  return glm::mix(texel_at(texels(finer), side(finer), place),
                  texel_at(texels(coarser), side(coarser), place),
                  level - static_cast<float>(finer));
}

std::array<glm::vec3, 9> Environment::harmonics(const glm::mat3& map_from_world) const {
  std::array<glm::vec3, 9> sh{};
  // Second-order harmonics are smooth: a quarter of the resolution is plenty.
  const int level = std::min(2, static_cast<int>(pyramid_.size()) - 1);
  const auto& cube = pyramid_[static_cast<std::size_t>(level)];
  const glm::mat3 world_from_map = glm::transpose(map_from_world);
  for_each_texel(side(level), [&](std::size_t index, const glm::vec3& direction, float share) {
    const glm::vec3 n = world_from_map * direction;
    const glm::vec3 light = 4.0F * kPi * share * cube[index];
    const std::array<float, 9> basis = {0.282095F,
                                        0.488603F * n.y,
                                        0.488603F * n.z,
                                        0.488603F * n.x,
                                        1.092548F * n.x * n.y,
                                        1.092548F * n.y * n.z,
                                        0.315392F * (3.0F * n.z * n.z - 1.0F),
                                        1.092548F * n.x * n.z,
                                        0.546274F * (n.x * n.x - n.y * n.y)};
    for (std::size_t i = 0; i < 9; ++i) sh[i] += basis[i] * light;
  });
  return sh;
}

}  // namespace planecast::render
