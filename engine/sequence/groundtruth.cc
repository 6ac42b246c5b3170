#include "engine/sequence/groundtruth.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "engine/sequence/list_file.h"
#include "engine/user_error.h"

namespace planecast::engine {

std::vector<TimedPose> read_trajectory(const std::filesystem::path& file) {
  std::vector<TimedPose> poses;
  for (const ListLine& line : read_list_lines(file)) {
    std::array<double, 8> value{};
    bool good = line.fields.size() == value.size();
    for (std::size_t i = 0; good && i < value.size(); ++i) {
      const auto number = parse_number(line.fields[i]);
      good = number.has_value();
      if (good) value[i] = *number;
    }
    const Eigen::Quaterniond q(value[7], value[4], value[5], value[6]);
    if (!good || q.norm() < 1e-6) {
      throw UserError(fmt::format("{}:{}: expected 'timestamp tx ty tz qx qy qz qw'", file.string(),
                                  line.number));
    }
    TimedPose pose;
    pose.timestamp = value[0];
    pose.world_from_cam.linear() = q.normalized().toRotationMatrix();
    pose.world_from_cam.translation() = Eigen::Vector3d(value[1], value[2], value[3]);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace planecast::engine
