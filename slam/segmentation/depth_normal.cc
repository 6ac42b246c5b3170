#include "slam/segmentation/depth_normal.h"

#include <algorithm>

#include "slam/segmentation/depth_blocks.h"

namespace planecast::slam {

namespace {

constexpr int kSteps = 2;  ///< samples on either side of the pixel, per axis
constexpr int kMinSamples = 20;
/// Mean squared residual over the expected one.
constexpr double kMaxChi2 = 4.0;

}  // namespace

std::optional<Eigen::Vector3d> surface_normal(const cv::Mat& depth, const Camera& camera, int x,
                                              int y, int radius_px, double metre) {
  const int step = std::max(radius_px / kSteps, 1);
  const int reach = kSteps * step;
  if (x < reach || y < reach || x + reach >= depth.cols || y + reach >= depth.rows) return {};
  const Eigen::Vector2d raw(x, y);
  const Eigen::Vector2d centre = camera.has_distortion() ? camera.undistort(raw) : raw;
  InverseDepthSums sums;
  for (int dy = -reach; dy <= reach; dy += step) {
    const float* row = depth.ptr<float>(y + dy);
    for (int dx = -reach; dx <= reach; dx += step) {
      const double z = row[x + dx] / metre;
      if (!(z > 0.0)) continue;
      // Over so few pixels the lens only shifts them.
      const Eigen::Vector3d ray = camera.ray(centre + Eigen::Vector2d(dx, dy));
      sums.add(ray.x(), ray.y(), 1.0 / z, inverse_depth_sigma(z));
    }
  }
  if (sums.count < kMinSamples) return {};
  const Eigen::Vector3d theta = sums.solve();
  if (!theta.allFinite() || !(theta.norm() > 0.0) || sums.chi2(theta) > kMaxChi2) return {};
  // theta . point = 1 on the plane, so that theta points away from the camera.
  return -theta.normalized();
}

}  // namespace planecast::slam
