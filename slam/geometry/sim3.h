#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/data/types.h"

namespace planecast::slam {

/// target = scale * rotation * source + translation.
struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& source) const {
    return scale * (rotation * source) + translation;
  }
  Similarity operator*(const Similarity& first) const {
    return {scale * first.scale, rotation * first.rotation, *this * first.translation};
  }
  Similarity inverse() const {
    return {1.0 / scale, rotation.transpose(), -(rotation.transpose() * translation) / scale};
  }
};

inline Similarity similarity_from_pose(const Pose& pose) {
  return {1.0, pose.linear(), pose.translation()};
}
/// The rigid transform that maps to the target's axes in the source's units.
inline Pose pose_in_source_units(const Similarity& target_from_source) {
  Pose pose = Pose::Identity();
  pose.linear() = target_from_source.rotation;
  pose.translation() = target_from_source.translation / target_from_source.scale;
  return pose;
}

/// Least-squares alignment (Umeyama 1991) of source points on target points; at least 3 of each,
/// not collinear. With `with_scale` false the scale is 1 (SE3).
Similarity align_points(const std::vector<Eigen::Vector3d>& source,
                        const std::vector<Eigen::Vector3d>& target, bool with_scale);

}  // namespace planecast::slam
