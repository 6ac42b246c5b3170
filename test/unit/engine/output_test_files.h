#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "engine/output/atomic_file.h"
#include "engine/pipeline/reconstruction.h"
#include "engine/user_error.h"

namespace planecast::engine {

/// An empty folder of the running test's own, removed at its end.
class TestFolder {
 public:
  TestFolder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("planecast_") + info->test_suite_name() + "_" + info->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// The one line of the UserError that `action` throws; "" if it throws none.
inline std::string user_error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

inline slam::Pose make_pose(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation) {
  slam::Pose pose = slam::Pose::Identity();
  if (rotation.norm() > 0.0) {
    pose.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
  }
  pose.translation() = translation;
  return pose;
}

inline slam::Camera test_camera() {
  slam::Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525.0;
  camera.fy = 530.0;
  camera.cx = 318.0;
  camera.cy = 242.0;
  return camera;
}

/// A rectangle in the plane's own frame: counter-clockwise from the normal's side, z = normal.
inline PlaneRecord make_rectangle(int id, const Eigen::Vector3d& center,
                                  const Eigen::Vector3d& normal, const Eigen::Vector3d& x_axis,
                                  double width, double height) {
  PlaneRecord plane;
  plane.id = id;
  plane.label = id + 1;
  plane.normal = normal.normalized();
  plane.offset = -plane.normal.dot(center);
  plane.origin = center;
  plane.x_axis = x_axis.normalized();
  const Eigen::Vector3d y_axis = plane.normal.cross(plane.x_axis);
  for (const auto& [u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    plane.polygon.emplace_back(center + u * width * plane.x_axis + v * height * y_axis);
  }
  plane.area = width * height;
  return plane;
}

}  // namespace planecast::engine
