#include "render/passes/view.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace planecast::render {
namespace {

/// Smallest and largest pixel coordinates met so far.
struct Extent {
  float min_u = 1e9F, min_v = 1e9F, max_u = -1e9F, max_v = -1e9F;

  void add(const Camera& camera, const glm::vec3& in_camera) {
    const float u = camera.fx * in_camera.x / in_camera.z + camera.cx;
    const float v = camera.fy * in_camera.y / in_camera.z + camera.cy;
    min_u = std::min(min_u, u);
    max_u = std::max(max_u, u);
    min_v = std::min(min_v, v);
    max_v = std::max(max_v, v);
  }
};

/// Points in groups of `corners`, each the corners of something convex.
Layer::Rect bounds_of_groups(const Camera& camera, const std::vector<glm::vec3>& points,
                             std::size_t corners) {
  Layer::Rect bounds;
  for (std::size_t i = 0; i < points.size(); i += corners) {
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(i);
    bounds = united(
        bounds, projected_bounds(camera, {first, first + static_cast<std::ptrdiff_t>(corners)}));
  }
  return bounds;
}

}  // namespace

glm::mat4 clip_from_camera(const Camera& camera) {
  const float width = static_cast<float>(camera.width);
  const float height = static_cast<float>(camera.height);
  const float near = camera.near_plane;
  const float far = camera.far_plane;
  glm::mat4 clip(0.0F);
  clip[0][0] = 2.0F * camera.fx / width;
  clip[1][1] = 2.0F * camera.fy / height;
  clip[2][0] = 2.0F * (camera.cx + 0.5F) / width - 1.0F;
  clip[2][1] = 2.0F * (camera.cy + 0.5F) / height - 1.0F;
  clip[2][2] = -near / (far - near);
  clip[2][3] = 1.0F;
  clip[3][2] = near * far / (far - near);
  return clip;
}

glm::vec3 camera_position(const Camera& camera) {
  return glm::vec3(glm::inverse(camera.camera_from_world)[3]);
}

GLenum front_face(const Camera& camera, const glm::mat4& world_from_model) {
  const float handedness = glm::determinant(glm::mat3(camera.camera_from_world)) *
                           glm::determinant(glm::mat3(world_from_model));
  return camera.fy * camera.fx * handedness > 0.0F ? GL_CW : GL_CCW;
}

std::array<glm::vec3, 8> box_corners(const Box& box, const glm::mat4& target_from_box) {
  std::array<glm::vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec3 corner((i & 1U) != 0 ? box.max.x : box.min.x,
                           (i & 2U) != 0 ? box.max.y : box.min.y,
                           (i & 4U) != 0 ? box.max.z : box.min.z);
    corners[i] = glm::vec3(target_from_box * glm::vec4(corner, 1.0F));
  }
  return corners;
}

Layer::Rect projected_bounds(const Camera& camera, const std::vector<glm::vec3>& points) {
  std::vector<glm::vec3> front;
  std::vector<glm::vec3> behind;
  for (const glm::vec3& point : points) {
    const glm::vec3 p = glm::vec3(camera.camera_from_world * glm::vec4(point, 1.0F));
    (p.z >= camera.near_plane ? front : behind).push_back(p);
  }
  Extent extent;
  for (const glm::vec3& p : front) {
    extent.add(camera, p);
    for (const glm::vec3& q : behind) {
      const float t = (p.z - camera.near_plane) / (p.z - q.z);
      extent.add(camera, p + t * (q - p));
    }
  }
  const int x0 = std::max(0, static_cast<int>(std::floor(std::max(extent.min_u, -1.0F))));
  const int y0 = std::max(0, static_cast<int>(std::floor(std::max(extent.min_v, -1.0F))));
  const float width = static_cast<float>(camera.width);
  const float height = static_cast<float>(camera.height);
  const int x1 =
      std::min(camera.width, static_cast<int>(std::ceil(std::min(extent.max_u, width))) + 1);
  const int y1 =
      std::min(camera.height, static_cast<int>(std::ceil(std::min(extent.max_v, height))) + 1);
  if (x1 <= x0 || y1 <= y0) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

Layer::Rect united(const Layer::Rect& a, const Layer::Rect& b) {
  if (a.width == 0) return b;
  if (b.width == 0) return a;
  const int x0 = std::min(a.x, b.x);
  const int y0 = std::min(a.y, b.y);
  const int x1 = std::max(a.x + a.width, b.x + b.width);
  const int y1 = std::max(a.y + a.height, b.y + b.height);
  return {x0, y0, x1 - x0, y1 - y0};
}

Layer::Rect grown(const Layer::Rect& rect, int pixels, const Camera& camera) {
  if (rect.width == 0) return rect;
  const int x0 = std::max(0, rect.x - pixels);
  const int y0 = std::max(0, rect.y - pixels);
  const int x1 = std::min(camera.width, rect.x + rect.width + pixels);
  const int y1 = std::min(camera.height, rect.y + rect.height + pixels);
  return {x0, y0, x1 - x0, y1 - y0};
}

Layer::Rect layer_bounds(const Camera& camera, const std::vector<glm::vec3>& box_points,
                         const std::vector<glm::vec3>& shadow_points) {
  // One pixel for the resolve, one for rounding.
  constexpr int kMargin = 2;
  return grown(
      united(bounds_of_groups(camera, box_points, 8), bounds_of_groups(camera, shadow_points, 4)),
      kMargin, camera);
}

}  // namespace planecast::render
