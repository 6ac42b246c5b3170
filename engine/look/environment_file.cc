#include "engine/look/environment_file.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>

#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// A sun and its glare are within this angle; around it, up to the second, is plain sky.
constexpr float kSunAngle = 0.05F;
constexpr float kSkyAngle = 0.1F;
/// Anything less is no main light.
constexpr float kSmallestShare = 0.1F;

float luminance(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.2126F, 0.7152F, 0.0722F));
}

struct MapTexel {
  glm::vec3 direction{};
  float solid_angle = 0.0F;
  float* rgb = nullptr;

  glm::vec3 radiance() const { return {rgb[0], rgb[1], rgb[2]}; }
};

template <typename Visit>
void for_each_texel(render::ImageF& map, const Visit& visit) {
  const glm::vec2 size(map.width, map.height);
  const float pi = std::numbers::pi_v<float>;
  float* rgb = map.pixels.data();
  for (int y = 0; y < map.height; ++y) {
    const float row = std::sin(pi * (static_cast<float>(y) + 0.5F) / size.y);
    for (int x = 0; x < map.width; ++x, rgb += 3) {
      visit(MapTexel{render::equirectangular_direction((glm::vec2(x, y) + 0.5F) / size),
                     row * 2.0F * pi * pi / (size.x * size.y), rgb});
    }
  }
}

/// The brightest place, when a fair share of all light comes from it, as a sun; the sky around it
/// takes its place in the map.
render::Sun take_sun(render::ImageF& map) {
  glm::vec3 brightest{0.0F, 1.0F, 0.0F};
  float most = 0.0F;
  glm::vec3 total(0.0F);
  for_each_texel(map, [&](const MapTexel& texel) {
    total += texel.solid_angle * texel.radiance();
    if (luminance(texel.radiance()) <= most) return;
    most = luminance(texel.radiance());
    brightest = texel.direction;
  });
  glm::vec3 inner(0.0F);
  glm::vec3 around(0.0F);
  float inner_angle = 0.0F;
  float around_angle = 0.0F;
  const float sun_cosine = std::cos(kSunAngle);
  const float sky_cosine = std::cos(kSkyAngle);
  for_each_texel(map, [&](const MapTexel& texel) {
    const float cosine = glm::dot(texel.direction, brightest);
    if (cosine >= sun_cosine) {
      inner += texel.solid_angle * texel.radiance();
      inner_angle += texel.solid_angle;
    } else if (cosine >= sky_cosine) {
      around += texel.solid_angle * texel.radiance();
      around_angle += texel.solid_angle;
    }
  });
  render::Sun sun;
  sun.radiance = glm::vec3(0.0F);
  sun.direction_to_light = brightest;
  if (!(around_angle > 0.0F)) return sun;
  const glm::vec3 sky = around / around_angle;
  const glm::vec3 more = glm::max(inner - inner_angle * sky, glm::vec3(0.0F));
  if (!(luminance(more) > kSmallestShare * luminance(total))) return sun;
  // Irradiance / pi on a facing surface.
  sun.radiance = more / std::numbers::pi_v<float>;
  sun.angular_radius_rad = 0.0046F;
  for_each_texel(map, [&](const MapTexel& texel) {
    if (glm::dot(texel.direction, brightest) < sun_cosine) return;
    for (int c = 0; c < 3; ++c) texel.rgb[c] = sky[c];
  });
  return sun;
}

/// What a white level surface sends back, irradiance / pi.
glm::vec3 white_ground(const std::array<glm::vec3, 9>& sh, const render::Sun& sun) {
  // The cosine lobe's bands at n = +y: see diffuse_ambient in ambient.glsl.
  const glm::vec3 sky = 0.282095F * sh[0] + (2.0F / 3.0F) * 0.488603F * sh[1] -
                        0.25F * (0.315392F * sh[6] + 0.546274F * sh[8]);
  return glm::max(sky, glm::vec3(0.0F)) + std::max(sun.direction_to_light.y, 0.0F) * sun.radiance;
}

}  // namespace

EnvironmentLight environment_light(render::ImageF map) {
  for (float& value : map.pixels) value = std::isfinite(value) ? std::max(value, 0.0F) : 0.0F;
  EnvironmentLight light;
  light.sun = take_sun(map);
  light.environment = std::make_shared<render::Environment>(map);
  const float white =
      luminance(white_ground(light.environment->harmonics(glm::mat3(1.0F)), light.sun));
  if (white > 0.0F) light.exposure = 1.0F / white;
  return light;
}

EnvironmentLight load_environment(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw UserError(file.string() + ": no such file");
  }
  cv::Mat bgr;
  try {
    bgr = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    // Said below.
  }
  if (bgr.type() != CV_32FC3 || bgr.empty()) {
    throw UserError(file.string() + ": not a picture of radiance (.hdr)");
  }
  if (bgr.cols != 2 * bgr.rows) {
    throw UserError(file.string() + ": an equirectangular picture is twice as wide as high");
  }
  render::ImageF map(bgr.cols, bgr.rows, 3);
  float* out = map.pixels.data();
  for (int y = 0; y < bgr.rows; ++y) {
    const auto* row = bgr.ptr<cv::Vec3f>(y);
    for (int x = 0; x < bgr.cols; ++x, out += 3) {
      for (int c = 0; c < 3; ++c) out[c] = row[x][2 - c];
    }
  }
  return environment_light(std::move(map));
}

}  // namespace planecast::engine
