#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/data/types.h"

namespace planecast::slam {

/// Where a sampled depth point was measured, so that it can follow its keyframe.
struct DepthAnchor {
  KeyframeId keyframe = kNone;
  Eigen::Vector3f point_cam;  ///< metres, in that keyframe's camera
};

/// A plane landmark: normal . x + offset = 0 in the world, the unit normal on the side of the
/// cameras that saw it. Its own frame (plane_from_world) has z = normal, its origin at the first
/// centroid and x along the first observing camera's x; refits turn it by the smallest rotation and
/// shift it along the normal only, so that content anchored in it does not slide.
struct Plane {
  PlaneId id = kNone;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();   ///< on the plane
  Eigen::Vector3d x_axis = Eigen::Vector3d::UnitX();  ///< unit, in the plane
  bool weak = false;  ///< too few landmarks yet: kept apart, merged or dropped later
  int inliers = 0;    ///< landmarks that own it
  double rms = 0.0;   ///< of their distances, map units
  int first_frame = 0;
  int label = 0;                      ///< mask label at its birth, 0 = none
  int age_keyframes = 0;              ///< keyframes since birth
  std::vector<KeyframeId> observers;  ///< ascending
  std::vector<PlaneId> merged_from;   ///< ids that were merged into this one, ascending
  int doubts = 0;  ///< keyframes, less the good ones, in which it did not look like a plane
  int stalled_keyframes = 0;  ///< keyframes since it last gained support
  std::vector<Eigen::Vector3d>
      depth_points;  ///< RGB-D: sampled support in the world, beside landmarks
  std::vector<DepthAnchor> depth_anchors;  ///< of depth_points, one each

  double signed_distance(const Eigen::Vector3d& point_world) const {
    return normal.dot(point_world) + offset;
  }
  Pose world_from_plane() const;
  /// Takes a new equation, moving the frame as said above. `new_normal` is a unit vector.
  void refit(const Eigen::Vector3d& new_normal, double new_offset);
};

}  // namespace planecast::slam
