#include "slam/geometry/sim3.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace planecast::slam {
namespace {

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return points.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(points.size()));
}

}  // namespace

Similarity align_points(const std::vector<Eigen::Vector3d>& source,
                        const std::vector<Eigen::Vector3d>& target, bool with_scale) {
  const Eigen::Vector3d source_mean = mean_of(source);
  const Eigen::Vector3d target_mean = mean_of(target);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double source_variance = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d from_mean = source[i] - source_mean;
    covariance += (target[i] - target_mean) * from_mean.transpose();
    source_variance += from_mean.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Umeyama's S (equations 39 and 43): turns the best reflection into the best rotation.
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;

  Similarity similarity;
  similarity.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  if (with_scale && source_variance > 0.0) {
    similarity.scale = svd.singularValues().dot(sign) / source_variance;
  }
  similarity.translation = target_mean - similarity.scale * (similarity.rotation * source_mean);
  return similarity;
}

}  // namespace planecast::slam
