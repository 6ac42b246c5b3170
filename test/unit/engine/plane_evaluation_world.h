#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/evaluate/overlay.h"
#include "engine/evaluate/patch.h"
#include "engine/evaluate/planes.h"
#include "test/unit/engine/output_test_files.h"

namespace planecast::engine {

inline constexpr double kMapScale = 0.4;  ///< map units in a metre

/// A room's corner seen by a camera that sways in front of it: y down, floor at y = 1.
class PlaneEvaluation : public ::testing::Test {
 protected:
  void SetUp() override {
    camera = test_camera();
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    truth = {make_rectangle(0, {0.0, 1.0, 3.0}, -Eigen::Vector3d::UnitY(), x, 3.0, 2.0),
             make_rectangle(1, {0.0, 0.0, 4.0}, -Eigen::Vector3d::UnitZ(), x, 3.0, 2.0),
             make_rectangle(2, {-0.8, 0.4, 3.0}, -Eigen::Vector3d::UnitY(), x, 0.8, 0.6),
             make_rectangle(3, {0.8, 0.4, 3.0}, -Eigen::Vector3d::UnitY(), x, 0.8, 0.6),
             make_rectangle(4, {0.0, 0.0, -4.0}, Eigen::Vector3d::UnitZ(), x, 3.0, 2.0)};  // behind
    for (int i = 0; i < 60; ++i) {
      const double a = 0.1 * i;
      truth_poses.push_back(
          {i / 30.0, make_pose({0.05 * std::sin(a), 0.08 * std::cos(a), 0.0},
                               {0.4 * std::cos(a), 0.2 * std::sin(2.0 * a), 0.3 * std::sin(a)})});
    }
    estimate = in_own_world();
  }

  /// The truth without error, as a monocular system would have it: another world, another scale.
  Reconstruction in_own_world() const {
    slam::Similarity map_from_world;
    map_from_world.scale = kMapScale;
    map_from_world.rotation = make_pose({0.4, -0.2, 0.1}, {}).linear();
    map_from_world.translation = Eigen::Vector3d(1.0, -0.5, 2.0);
    Reconstruction map;
    map.camera = camera;
    for (std::size_t t = 0; t < 4; ++t) {
      map.planes.push_back(transformed(map_from_world, truth[t]));
      map.planes.back().id = 10 + static_cast<int>(t);
      for (const Eigen::Vector3d& position : Patch(truth[t]).grid(10)) {
        MapPoint point;
        point.position = map_from_world * position;
        point.plane = map.planes.back().id;
        map.points.push_back(point);
      }
    }
    for (std::size_t i = 0; i < truth_poses.size(); ++i) {
      FrameRecord frame;
      frame.index = static_cast<int>(i);
      frame.timestamp = truth_poses[i].timestamp;
      frame.world_from_cam = slam::Pose::Identity();
      frame.world_from_cam->linear() =
          map_from_world.rotation * truth_poses[i].world_from_cam.linear();
      frame.world_from_cam->translation() =
          map_from_world * truth_poses[i].world_from_cam.translation();
      map.frames.push_back(frame);
    }
    return map;
  }

  PlaneResult evaluate() const {
    return evaluate_planes(estimate, truth, truth_poses, camera).value_or(PlaneResult());
  }
  OverlayResult drift(const OverlayOptions& options = {}) const {
    return evaluate_overlay(estimate, truth, truth_poses, camera, options)
        .value_or(OverlayResult());
  }
  /// Moves a plane and its points along its normal, in metres.
  void lift(std::size_t plane, double metres) {
    PlaneRecord& moved = estimate.planes[plane];
    const Eigen::Vector3d step = metres * kMapScale * moved.normal;
    moved.offset -= metres * kMapScale;
    moved.origin += step;
    for (Eigen::Vector3d& vertex : moved.polygon) vertex += step;
    for (MapPoint& point : estimate.points) {
      if (point.plane == moved.id) point.position += step;
    }
  }

  slam::Camera camera;
  std::vector<PlaneRecord> truth;
  std::vector<TimedPose> truth_poses;
  Reconstruction estimate;
};

}  // namespace planecast::engine
