#pragma once

#include <Eigen/Geometry>
#include <glm/glm.hpp>

#include "render/scene.h"
#include "slam/data/camera.h"
#include "slam/data/types.h"

/// The one bridge between Eigen (slam) and GLM (render).
namespace planecast::engine {

inline glm::vec3 to_glm(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

inline Eigen::Vector3d to_eigen(const glm::vec3& v) { return {v.x, v.y, v.z}; }

inline glm::mat4 to_glm(const Eigen::Matrix4d& m) {
  glm::mat4 out;
  for (int col = 0; col < 4; ++col) {
    for (int row = 0; row < 4; ++row) out[col][row] = static_cast<float>(m(row, col));
  }
  return out;
}

inline glm::mat4 to_glm(const slam::Pose& target_from_source) {
  return to_glm(Eigen::Matrix4d(target_from_source.matrix()));
}

/// The ideal pinhole of a camera (its distortion is left to whoever draws) at a pose.
inline render::Camera to_render_camera(const slam::Camera& camera,
                                       const slam::Pose& cam_from_world) {
  render::Camera out;
  out.width = camera.width;
  out.height = camera.height;
  out.fx = static_cast<float>(camera.fx);
  out.fy = static_cast<float>(camera.fy);
  out.cx = static_cast<float>(camera.cx);
  out.cy = static_cast<float>(camera.cy);
  out.camera_from_world = to_glm(cam_from_world);
  return out;
}

}  // namespace planecast::engine
