#include "render/software/screen_polygon.h"

#include <cmath>

namespace planecast::render {
namespace {

/// Sutherland and Hodgman 1974: keeps what lies where `distance` is not negative.
template <typename Point, typename Distance>
std::vector<Point> clipped(const std::vector<Point>& ring, const Distance& distance) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point& a = ring[i];
    const Point& b = ring[(i + 1) % ring.size()];
    const float da = distance(a);
    const float db = distance(b);
    if (da >= 0.0F) kept.push_back(a);
    if ((da >= 0.0F) != (db >= 0.0F)) kept.push_back(a + (da / (da - db)) * (b - a));
  }
  return kept;
}

}  // namespace

std::vector<glm::vec2> clip_to_window(const std::vector<glm::vec3>& ring,
                                      const glm::mat4& camera_from_ring, const Camera& camera,
                                      const Window& window) {
  std::vector<glm::vec3> seen;
  seen.reserve(ring.size());
  for (const glm::vec3& point : ring) seen.emplace_back(camera_from_ring * glm::vec4(point, 1.0F));
  seen = clipped(seen, [&](const glm::vec3& p) { return p.z - camera.near_plane; });
  std::vector<glm::vec2> pixels;
  pixels.reserve(seen.size());
  const Layer::Rect& rect = window.rect;
  for (const glm::vec3& p : seen) {
    pixels.emplace_back(camera.fx * p.x / p.z + camera.cx - static_cast<float>(rect.x),
                        camera.fy * p.y / p.z + camera.cy - static_cast<float>(rect.y));
  }
  const float right = static_cast<float>(rect.width) + 0.5F;
  const float bottom = static_cast<float>(rect.height) + 0.5F;
  pixels = clipped(pixels, [](const glm::vec2& p) { return p.x + 1.5F; });
  pixels = clipped(pixels, [&](const glm::vec2& p) { return right - p.x; });
  pixels = clipped(pixels, [](const glm::vec2& p) { return p.y + 1.5F; });
  return clipped(pixels, [&](const glm::vec2& p) { return bottom - p.y; });
}

glm::vec2 depth_coefficients(const Camera& camera) {
  const float range = camera.far_plane - camera.near_plane;
  return {-camera.near_plane / range, camera.near_plane * camera.far_plane / range};
}

DepthPlane depth_of_plane(const glm::vec4& camera_equation, const Camera& camera,
                          const Window& window) {
  // On the plane 1 / z = -(n . ray) / d, with the ray ((u - cx) / fx, (v - cy) / fy, 1).
  const float d = camera_equation.w == 0.0F ? 1e-12F : camera_equation.w;
  const float x = -camera_equation.x / (d * camera.fx);
  const float y = -camera_equation.y / (d * camera.fy);
  const float at_centre = -camera_equation.z / d;
  const float left = static_cast<float>(window.rect.x) - camera.cx;
  const float top = static_cast<float>(window.rect.y) - camera.cy;
  const glm::vec2 depth = depth_coefficients(camera);
  return {depth.y * x, depth.y * y, depth.x + depth.y * (at_centre + x * left + y * top)};
}

}  // namespace planecast::render
