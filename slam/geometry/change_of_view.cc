#include "slam/geometry/change_of_view.h"

#include <Eigen/LU>

#include "slam/geometry/lens.h"

namespace planecast::slam {

std::optional<Eigen::Matrix2d> change_of_view(const Camera& camera,
                                              const Eigen::Vector3d& point_ref,
                                              const Eigen::Vector3d& normal_ref,
                                              const Pose& cam_from_ref) {
  const Eigen::Vector3d point_cam = cam_from_ref * point_ref;
  if (!(point_ref.z() > 0.0 && point_cam.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(point_ref);
  const double along = normal_ref.dot(point_ref);
  const auto image_of = [&](const Eigen::Vector2d& offset) {
    const Eigen::Vector3d ray = camera.ray(pixel + offset);
    return camera.project(cam_from_ref * (ray * (along / normal_ref.dot(ray))));
  };
  constexpr double kReach = 2.0;  // px
  Eigen::Matrix2d undistorted;
  undistorted.col(0) = (image_of({kReach, 0.0}) - image_of({-kReach, 0.0})) / (2.0 * kReach);
  undistorted.col(1) = (image_of({0.0, kReach}) - image_of({0.0, -kReach})) / (2.0 * kReach);
  if (!undistorted.allFinite()) return std::nullopt;
  if (!camera.has_distortion()) return undistorted;
  return Eigen::Matrix2d(raw_by_undistorted(camera, camera.project(point_cam)) * undistorted *
                         raw_by_undistorted(camera, pixel).inverse());
}

}  // namespace planecast::slam
