#pragma once

#include <Eigen/Geometry>
#include <glm/glm.hpp>

#include "render/scene.h"
#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::engine {

/// The one bridge between Eigen (slam) and GLM (render). Values are narrowed to float.

inline glm::vec3 to_glm(const Eigen::Vector3d& v) { return glm::vec3(glm::dvec3(v.x(), v.y(), v.z())); }

inline glm::mat4 to_glm(const Eigen::Matrix4d& m) {
  glm::mat4 result;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) result[column][row] = static_cast<float>(m(row, column));
  }
  return result;
}

/// The undistorted pinhole of `camera` at a pose.
inline render::Camera to_render_camera(const slam::Camera& camera, const slam::Pose& cam_from_world) {
  render::Camera result;
  result.width = camera.width;
  result.height = camera.height;
  result.fx = static_cast<float>(camera.fx);
  result.fy = static_cast<float>(camera.fy);
  result.cx = static_cast<float>(camera.cx);
  result.cy = static_cast<float>(camera.cy);
  result.camera_from_world = to_glm(cam_from_world.matrix());
  return result;
}

}  // namespace planecast::engine
