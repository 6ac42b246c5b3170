#include "engine/output/trajectory.h"

#include <fmt/format.h>

#include <cstdlib>

#include "engine/output/atomic_file.h"

namespace planecast::engine {

std::string format_timestamp(double seconds) {
  std::string text = fmt::format("{:.6f}", seconds);
  if (std::strtod(text.c_str(), nullptr) != seconds) text = fmt::format("{}", seconds);
  return text;
}

std::string trajectory_text(const std::vector<TimedPose>& poses) {
  std::string text = "# timestamp tx ty tz qx qy qz qw (world from camera)\n";
  for (const TimedPose& pose : poses) {
    const Eigen::Vector3d t = pose.world_from_cam.translation();
    Eigen::Quaterniond q(pose.world_from_cam.linear());
    q.normalize();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    text += format_timestamp(pose.timestamp);
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += fmt::format(" {:.12f}", value);
    }
    text += '\n';
  }
  return text;
}

void write_trajectory(const std::vector<TimedPose>& poses, const std::filesystem::path& path) {
  write_file(path, trajectory_text(poses));
}

}  // namespace planecast::engine
