#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "engine/sequence/synth/room_model.h"

namespace planecast::engine::synth {

/// A pinhole without distortion; pixels need not be square.
struct RasterCamera {
  int width = 0;
  int height = 0;
  float fx = 0.0F;
  float fy = 0.0F;
  float cx = 0.0F;
  float cy = 0.0F;
  Eigen::Isometry3f cam_from_world = Eigen::Isometry3f::Identity();

  Eigen::Vector3f ray(float x, float y) const { return {(x - cx) / fx, (y - cy) / fy, 1.0F}; }
};

/// A triangle of a patch with what is interpolated over it; world coordinates.
struct RasterTriangle {
  Eigen::Vector3f corner, edge_a, edge_b;
  Eigen::Vector3f normal, normal_a, normal_b;  ///< at the corner, and what changes along the edges
  Eigen::Vector2f uv, uv_a, uv_b;              ///< metres on the patch, likewise
  int patch = 0;
};

std::vector<RasterTriangle> triangles_of(const RoomModel& model);

/// What is seen through each pixel's middle.
struct RasterImage {
  std::vector<float> inverse_depth;  ///< 1/z, 0: nothing
  std::vector<int> triangle;         ///< -1: nothing
};
RasterImage rasterise(const std::vector<RasterTriangle>& triangles, const RasterCamera& camera);

}  // namespace planecast::engine::synth
