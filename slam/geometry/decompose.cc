#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "slam/geometry/triangulate.h"
#include "slam/geometry/two_view.h"

namespace planecast::slam {
namespace {

/// Length of t over the plane's distance below which a homography is a rotation.
constexpr double kRotationOnly = 1e-9;

Pose pose_of(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation;
  pose.translation() = translation.normalized();
  return pose;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  sign.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

// Ma, Soatto, Kosecka, Sastry: An Invitation to 3-D Vision, section 5.3.3: with H scaled to a
// middle singular value of 1, H keeps the length of every vector of two planes, each spanned by v2
// and one of u1, u2; on them H is the rotation.
std::vector<Pose> decompose_homography(const Eigen::Matrix3d& cur_H_ref, const Camera& camera) {
  const Eigen::Matrix3d k = calibration_matrix(camera);
  Eigen::Matrix3d h = k.inverse() * cur_H_ref * k;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(h.transpose() * h);
  const Eigen::Vector3d squares = solver.eigenvalues();  // ascending
  if (!(squares(1) > 0.0) || !(squares(0) > 1e-12 * squares(2))) return {};
  h /= std::sqrt(squares(1)) * (h.determinant() < 0.0 ? -1.0 : 1.0);

  const double above = std::max(0.0, squares(2) / squares(1) - 1.0);
  const double below = std::max(0.0, 1.0 - squares(0) / squares(1));
  if (above + below <= kRotationOnly) return {};
  const Eigen::Vector3d v1 = solver.eigenvectors().col(2);
  const Eigen::Vector3d v2 = solver.eigenvectors().col(1);
  const Eigen::Vector3d v3 = solver.eigenvectors().col(0);
  std::vector<Pose> poses;
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Vector3d u =
        (std::sqrt(below) * v1 + sign * std::sqrt(above) * v3) / std::sqrt(above + below);
    const Eigen::Vector3d normal = v2.cross(u);
    Eigen::Matrix3d ref_axes, cur_axes;
    ref_axes << v2, u, normal;
    cur_axes << h * v2, h * u, (h * v2).cross(h * u);
    const Eigen::Matrix3d rotation = nearest_rotation(cur_axes * ref_axes.transpose());
    const Eigen::Vector3d translation = (h - rotation) * normal;
    if (translation.norm() <= kRotationOnly) continue;
    poses.push_back(pose_of(rotation, translation));
    poses.push_back(pose_of(rotation, -translation));
  }
  return poses;
}

// Hartley, Zisserman: Multiple View Geometry, result 9.19.
std::vector<Pose> decompose_fundamental(const Eigen::Matrix3d& cur_F_ref, const Camera& camera) {
  const Eigen::Matrix3d k = calibration_matrix(camera);
  const Eigen::Matrix3d essential = k.transpose() * cur_F_ref * k;
  if (!(essential.norm() > 0.0)) return {};
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d w = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  const Eigen::Vector3d translation = svd.matrixU().col(2);
  std::vector<Pose> poses;
  for (const Eigen::Matrix3d& turn : {w, Eigen::Matrix3d(w.transpose())}) {
    Eigen::Matrix3d rotation = svd.matrixU() * turn * svd.matrixV().transpose();
    if (rotation.determinant() < 0.0) rotation = -rotation;
    poses.push_back(pose_of(rotation, translation));
    poses.push_back(pose_of(rotation, -translation));
  }
  return poses;
}

}  // namespace planecast::slam
