#include "slam/segmentation/depth_blocks.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "slam/geometry/depth_noise.h"

namespace planecast::slam {

void InverseDepthSums::add(double x, double y, double inverse_z, double sigma) {
  const Eigen::Vector3d ray(x, y, 1.0);
  rays += ray * ray.transpose();
  cross += inverse_z * ray;
  square += inverse_z * inverse_z;
  variance += sigma * sigma;
  ++count;
}

InverseDepthSums& InverseDepthSums::operator+=(const InverseDepthSums& other) {
  rays += other.rays;
  cross += other.cross;
  square += other.square;
  variance += other.variance;
  count += other.count;
  return *this;
}

Eigen::Vector3d InverseDepthSums::solve() const { return rays.ldlt().solve(cross); }

double InverseDepthSums::chi2(const Eigen::Vector3d& theta) const {
  const double sum = square - 2.0 * theta.dot(cross) + theta.dot(rays * theta);
  return std::max(sum, 0.0) / variance;
}

double inverse_depth_sigma(double z_m) { return depth_sigma_m(z_m) / (z_m * z_m); }

DepthBlocks sum_blocks(const cv::Mat& depth, const cv::Mat& rays, int size_px) {
  DepthBlocks blocks;
  blocks.size_px = size_px;
  blocks.cols = (depth.cols + size_px - 1) / size_px;
  blocks.rows = (depth.rows + size_px - 1) / size_px;
  blocks.sums.resize(static_cast<std::size_t>(blocks.count()));
  for (int y = 0; y < depth.rows; ++y) {
    const float* z = depth.ptr<float>(y);
    const cv::Vec2f* ray = rays.ptr<cv::Vec2f>(y);
    InverseDepthSums* row = &blocks.sums[static_cast<std::size_t>(y / size_px * blocks.cols)];
    for (int x = 0; x < depth.cols; ++x) {
      if (z[x] > 0.0F)
        row[x / size_px].add(ray[x][0], ray[x][1], 1.0 / z[x], inverse_depth_sigma(z[x]));
    }
  }
  return blocks;
}

}  // namespace planecast::slam
