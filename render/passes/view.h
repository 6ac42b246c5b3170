#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/gl/functions.h"
#include "render/scene.h"
#include "render/vertex.h"

namespace planecast::render {

/// Projection for row 0 of the framebuffer = top row of the picture, pixel centres at integers:
///   u = fx x/z + cx  lands at window x = u + 0.5, v likewise.
/// Depth is reversed (near 1, far 0), so that a float depth buffer is precise everywhere.
glm::mat4 clip_from_camera(const Camera& camera);

/// Position of the camera's centre in the world.
glm::vec3 camera_position(const Camera& camera);

/// Which winding is the front in the window: glTF fronts are counter-clockwise, the window above is
/// the mirror image of OpenGL's, and a negative fy or a mirroring transform turns it once more.
GLenum front_face(const Camera& camera, const glm::mat4& world_from_model);

std::array<glm::vec3, 8> box_corners(const Box& box, const glm::mat4& target_from_box);

/// Pixels that the convex hull of `points` may touch, cut to the picture. Points behind the camera
/// are treated by clipping the hull's edges at the near plane.
Layer::Rect projected_bounds(const Camera& camera, const std::vector<glm::vec3>& points);

Layer::Rect united(const Layer::Rect& a, const Layer::Rect& b);

/// Width and height grow by `pixels` on each side, cut to the picture.
Layer::Rect grown(const Layer::Rect& rect, int pixels, const Camera& camera);

/// What a layer of objects with these box corners (eight each) and shadows on planes with these
/// corners (four each) may touch.
Layer::Rect layer_bounds(const Camera& camera, const std::vector<glm::vec3>& box_points,
                         const std::vector<glm::vec3>& shadow_points);

}  // namespace planecast::render
