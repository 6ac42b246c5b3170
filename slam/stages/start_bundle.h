#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::slam {

/// Corners of a reference image that were followed through the images after it.
struct FollowedCorners {
  /// Undistorted pixels, [frame][corner]; the first frame is the reference, the last the newest.
  std::vector<std::vector<Eigen::Vector2d>> pixels;
  std::vector<double> sigma_px;  ///< per corner
};

struct StartBundleOptions {
  int max_frames = 7;  ///< taken evenly from those there are; the first and the last are always in
  int min_frames = 4;
  int min_points = 100;
  double min_share = 0.8;         ///< of the corners, that all frames must agree on
  double max_depth_error = 0.05;  ///< relative standard deviation, of the median point
  /// Of the normalised residuals. Followed corners are good to a third of their sigma; under a
  /// great turn their patches shift with the slope of the surface, which a wrong pose can explain.
  double max_variance = 0.15;
  int checked_points = 100;  ///< whose depth's uncertainty is computed
  int trial_corners = 250;   ///< with which candidates are compared
  /// Another solution's variance must be so many times that of the best. A thousand residuals and
  /// more stand behind each, so that even a tenth is beyond chance.
  double min_variance_ratio = 1.15;
};

struct StartBundle {
  Pose newest_from_ref = Pose::Identity();
  std::vector<std::optional<Eigen::Vector3d>> points_ref;  ///< per corner, in the reference camera
  double depth_error = 0.0;  ///< relative standard deviation of the median point's depth
  double variance = 0.0;     ///< of the normalised residuals
  bool good = false;         ///< passes every test of the options
};

/// Bundle adjustment of all frames since the reference, from the relative pose of the first and the
/// last: what two views with little parallax leave open, many may tell. The uncertainty of the
/// depths comes from the normal equations (Schur complement, the scale taken out), times the
/// variance of the residuals. Nothing where the frames are too few or do not fit.
std::optional<StartBundle> bundle_start(const Camera& camera, const FollowedCorners& corners,
                                        const Pose& newest_from_ref,
                                        const StartBundleOptions& options = {});

/// The same from the best of several relative poses, told by bundles of some of the corners.
/// Nothing where another one leads elsewhere and fits nearly as well, or the result is not good.
std::optional<StartBundle> bundle_best_start(const Camera& camera, const FollowedCorners& corners,
                                             const std::vector<Pose>& newest_from_ref,
                                             const StartBundleOptions& options = {});

}  // namespace planecast::slam
