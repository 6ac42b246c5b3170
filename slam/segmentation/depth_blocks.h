#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace planecast::slam {

/// Sums of a least-squares plane in inverse depth: seen by a pinhole, a plane is 1/z = theta . (x,
/// y, 1) over the rays (x, y, 1). A structured-light sensor's noise is nearly constant in 1/z, so
/// that all pixels weigh the same, and sums of regions add up.
struct InverseDepthSums {
  Eigen::Matrix3d rays = Eigen::Matrix3d::Zero();   ///< sum of r r^T, r = (x, y, 1)
  Eigen::Vector3d cross = Eigen::Vector3d::Zero();  ///< sum of r / z
  double square = 0.0;                              ///< sum of 1 / z^2
  double variance = 0.0;                            ///< sum of the expected variances of 1/z
  int count = 0;

  void add(double x, double y, double inverse_z, double sigma);
  InverseDepthSums& operator+=(const InverseDepthSums& other);
  /// The least-squares theta.
  Eigen::Vector3d solve() const;
  /// Mean squared residual against `theta` over the mean expected variance: about 1 on a plane.
  double chi2(const Eigen::Vector3d& theta) const;
};

/// The image cut into square blocks with the sums of each.
struct DepthBlocks {
  int size_px = 8;
  int cols = 0;
  int rows = 0;
  std::vector<InverseDepthSums> sums;

  int count() const { return cols * rows; }
};

/// Expected standard deviation of 1/z for the sensor at depth z_m.
double inverse_depth_sigma(double z_m);

/// `depth` is CV_32F metres, `rays` CV_32FC2 of the same size (undistorted ray of each raw pixel).
DepthBlocks sum_blocks(const cv::Mat& depth, const cv::Mat& rays, int size_px);

}  // namespace planecast::slam
