#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// A landmark seen in one frame.
struct PoseObservation {
  Eigen::Vector3d point_world;
  Eigen::Vector2d pixel;  ///< undistorted
  double sigma_px = 1.0;  ///< standard deviation of the pixel
  double depth = 0.0;     ///< measured depth in metres; 0 = none (monocular)
};

/// Depth enters as the disparity of a virtual stereo pair: residual baseline_fx * (1/z - 1/depth),
/// with the pixel's sigma ([K], ORB-SLAM2 section III.A).
struct PoseOptions {
  int rounds = 4;
  int iterations = 10;        ///< a round
  double chi2_mono = 5.991;   ///< 95 %, 2 degrees of freedom
  double chi2_depth = 7.815;  ///< 95 %, 3 degrees of freedom
  double depth_baseline_m = 0.08;
  /// After the rounds once more with Cauchy at the spread that most inliers have: sights are mostly
  /// better than their sigma, and a few that are wrong by less than the thresholds bend the pose.
  bool weigh = true;
};

struct PoseResult {
  Pose cam_from_world = Pose::Identity();
  std::vector<char> inlier;  ///< per observation, after the last round
  int num_inliers = 0;
  double rms = 0.0;  ///< of the inliers' normalised residuals
  /// Second derivative of half the inliers' chi2 by a step of the pose (geometry/pose_system.h).
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Motion-only bundle adjustment: Gauss-Newton/LM with analytic Jacobians on se(3), Huber in the
/// first rounds, outliers left out between rounds and able to come back.
PoseResult optimize_pose(const Camera& camera, const Pose& initial_cam_from_world,
                         const std::vector<PoseObservation>& observations,
                         const PoseOptions& options = {});

}  // namespace planecast::slam
