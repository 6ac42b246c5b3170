#include "engine/output/match_move_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/output/atomic_file.h"

namespace planecast::engine {
namespace {

std::array<float, 3> to_float(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::array<float, 4> to_float(const Eigen::Quaterniond& q) {
  return {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
          static_cast<float>(q.w())};
}

/// Angles in degrees with R = Ry Rx Rz.
Eigen::Vector3d zxy_angles(const Eigen::Matrix3d& r) {
  const double x = std::asin(std::clamp(-r(1, 2), -1.0, 1.0));
  const double y = std::atan2(r(0, 2), r(2, 2));
  const double z = std::atan2(r(1, 0), r(1, 1));
  return Eigen::Vector3d(x, y, z) * (180.0 / std::numbers::pi);
}

}  // namespace

double frame_rate(const std::vector<FrameRecord>& frames) {
  constexpr double kUsual = 30.0;
  std::vector<double> differences;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    differences.push_back(frames[i].timestamp - frames[i - 1].timestamp);
  }
  if (differences.empty()) return kUsual;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle > 0.0 ? 1.0 / *middle : kUsual;
}

Eigen::Quaterniond gltf_from_world(const Eigen::Vector3d& up) {
  const Eigen::Vector3d flipped_up = flip_yz() * up.normalized();
  return Eigen::Quaterniond::FromTwoVectors(flipped_up, Eigen::Vector3d::UnitY()) *
         Eigen::Quaterniond(flip_yz());
}

CameraTrack camera_track(const std::vector<FrameRecord>& frames) {
  CameraTrack track;
  const double fps = frame_rate(frames);
  Eigen::Quaterniond previous = Eigen::Quaterniond::Identity();
  for (const FrameRecord& frame : frames) {
    if (!frame.world_from_cam) continue;
    Eigen::Quaterniond rotation(Eigen::Matrix3d(frame.world_from_cam->linear() * flip_yz()));
    rotation.normalize();
    // Importers interpolate component-wise: no jump to the opposite quaternion.
    if (rotation.dot(previous) < 0.0) rotation.coeffs() = -rotation.coeffs();
    previous = rotation;
    track.seconds.push_back(static_cast<float>((frame.index - frames.front().index) / fps));
    track.translations.push_back(to_float(frame.world_from_cam->translation()));
    track.rotations.push_back(to_float(rotation));
  }
  return track;
}

Reconstruction mirrored(Reconstruction scene) {
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  scene.camera.fy = -scene.camera.fy;
  scene.up = mirror * scene.up;
  for (FrameRecord& frame : scene.frames) {
    if (!frame.world_from_cam) continue;
    frame.world_from_cam->linear() = mirror * frame.world_from_cam->linear() * mirror;
    frame.world_from_cam->translation() = mirror * frame.world_from_cam->translation();
  }
  for (PlaneRecord& plane : scene.planes) {
    for (Eigen::Vector3d* v : {&plane.normal, &plane.origin, &plane.x_axis}) *v = mirror * *v;
    for (Eigen::Vector3d& vertex : plane.polygon) vertex = mirror * vertex;
    for (auto& hole : plane.holes) {
      for (Eigen::Vector3d& vertex : hole) vertex = mirror * vertex;
    }
  }
  for (MapPoint& point : scene.points) point.position = mirror * point.position;
  return scene;
}

void write_chan(const Reconstruction& reconstruction, const std::filesystem::path& path) {
  if (reconstruction.camera.fy < 0.0) {
    write_chan(mirrored(reconstruction), path);
    return;
  }
  const Eigen::Matrix3d turn = gltf_from_world(reconstruction.up).toRotationMatrix();
  const slam::Camera& camera = reconstruction.camera;
  const double fov = 2.0 * std::atan(camera.height / (2.0 * camera.fy)) * 180.0 / std::numbers::pi;
  std::string text;
  for (const FrameRecord& frame : reconstruction.frames) {
    if (!frame.world_from_cam) continue;
    const Eigen::Vector3d t = turn * frame.world_from_cam->translation();
    const Eigen::Vector3d angles = zxy_angles(turn * frame.world_from_cam->linear() * flip_yz());
    text += fmt::format("{} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n",
                        frame.index - reconstruction.frames.front().index + 1, t.x(), t.y(), t.z(),
                        angles.x(), angles.y(), angles.z(), fov);
  }
  write_file(path, text);
}

}  // namespace planecast::engine
