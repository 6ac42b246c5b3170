#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/data/types.h"

namespace planecast::slam {

/// One frame of a path, as it was localised.
struct PathPose {
  Pose cam_from_world = Pose::Identity();
  /// Inverse covariance of a step of the pose (geometry/pose_system.h): PoseResult::information
  /// over the variance of its normalised residuals.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
};

struct SmoothPathOptions {
  double max_chi2 = 12.6;  ///< a frame's pose is moved no further: 95 %, 6 degrees of freedom
  int rounds = 8;          ///< in which frames that went too far are held tighter
  int min_frames = 8;      ///< shorter paths stay as they are
  int window = 45;         ///< frames to either side from which the camera's unrest is told
  /// Least share of the unrest that is taken for motion, however noisy the poses claim to be.
  double min_motion_share = 0.02;
};

/// The path that is likeliest when each pose has its own uncertainty and the camera's acceleration
/// changes at random: a least-squares problem over the third differences of the poses and the
/// deviations from what was localised. How much the acceleration changes is told from the path
/// itself, less what the poses' uncertainty explains, so that real shaking stays. `path`: of
/// consecutive frames at even intervals.
std::vector<Pose> smooth_path(const std::vector<PathPose>& path,
                              const SmoothPathOptions& options = {});

}  // namespace planecast::slam
