#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// A hand-made reconstruction in metres: a level camera at the origin looks along z over a table
/// top (id 1, 0.5 m below, x -0.6..0.6, z 1..2) that stands on a floor (id 0, 1.3 m below, x -3..3,
/// z 0.5..4) in front of a wall (id 2, at z = 4, y -1.2..1.3). Up is -y. Three frames: 10 at the
/// origin, 11 lost, 12 moved by 0.2 m to the right.
inline PlaneRecord make_plane(int id, const std::vector<Eigen::Vector3d>& ring,
                              const Eigen::Vector3d& normal, const Eigen::Vector3d& x_axis) {
  PlaneRecord plane;
  plane.id = id;
  plane.normal = normal;
  plane.x_axis = x_axis;
  for (const Eigen::Vector3d& corner : ring)
    plane.origin += corner / static_cast<double>(ring.size());
  plane.offset = -normal.dot(plane.origin);
  plane.polygon = ring;
  plane.inliers = 200;
  plane.rms = 0.002;
  // Fan about the first corner: exact for the convex rings made here.
  for (std::size_t i = 2; i < ring.size(); ++i) {
    plane.area += 0.5 * (ring[i - 1] - ring[0]).cross(ring[i] - ring[0]).norm();
  }
  return plane;
}

/// Counter-clockwise seen from above (-y).
inline std::vector<Eigen::Vector3d> level_ring(double y, double x0, double x1, double z0,
                                               double z1) {
  return {{x0, y, z0}, {x1, y, z0}, {x1, y, z1}, {x0, y, z1}};
}

inline Reconstruction table_world() {
  Reconstruction world;
  world.camera.width = 640;
  world.camera.height = 480;
  world.camera.fx = world.camera.fy = 500.0;
  world.camera.cx = 319.5;
  world.camera.cy = 239.5;
  world.metric = true;
  world.mode = "rgbd";
  world.median_depth = 2.0;
  for (int index = 10; index < 13; ++index) {
    FrameRecord frame;
    frame.index = index;
    frame.timestamp = index / 30.0;
    frame.state = index == 11 ? "lost" : "tracked";
    frame.reason = index == 11 ? "too few matches" : "";
    if (index != 11) {
      slam::Pose pose = slam::Pose::Identity();
      pose.translation().x() = 0.1 * (index - 10);
      frame.world_from_cam = pose;
      frame.causal_world_from_cam = pose;
    }
    world.frames.push_back(frame);
  }
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  world.planes = {make_plane(0, level_ring(1.3, -3, 3, 0.5, 4), up, right),
                  make_plane(1, level_ring(0.5, -0.6, 0.6, 1, 2), up, right),
                  make_plane(2, {{-3, 1.3, 4}, {3, 1.3, 4}, {3, -1.2, 4}, {-3, -1.2, 4}},
                             -Eigen::Vector3d::UnitZ(), right)};
  world.up = up;
  world.up_confidence = 0.8;
  world.planes[0].plane_class = "floor";
  world.planes[1].plane_class = "horizontal";
  world.planes[2].plane_class = "wall";
  return world;
}

inline PlaneRecord& plane_by_id(Reconstruction& world, int id) {
  return world.planes[static_cast<std::size_t>(id)];
}

}  // namespace planecast::engine
