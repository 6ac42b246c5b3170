#include "engine/sequence/groundtruth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>

#include "engine/sequence/camera_file.h"
#include "engine/sequence/list_file.h"
#include "engine/sequence/numbered_frames.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

/// A rotation is accepted with an error of its columns up to this, then made exact.
constexpr double kNearlyOrthonormal = 0.05;

slam::Pose pose_of(const Eigen::Vector3d& position, const Eigen::Quaterniond& q) {
  slam::Pose pose = slam::Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

/// All fields of a line as numbers, at least `count` of them, or an empty list.
std::vector<double> numbers_of(const ListLine& line, std::size_t count) {
  std::vector<double> values;
  for (const std::string& field : line.fields) {
    const auto number = parse_number(field);
    if (!number) return {};
    values.push_back(*number);
  }
  return values.size() >= count ? values : std::vector<double>();
}

ListLine split_at_commas(const ListLine& line) {
  std::string text;
  for (const std::string& field : line.fields) text += field;
  ListLine result{line.number, {""}};
  for (const char c : text) {
    if (c == ',') {
      result.fields.emplace_back();
    } else {
      result.fields.back() += c;
    }
  }
  return result;
}

/// `timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z, ...` of the body in the world.
std::vector<TimedPose> read_euroc(const fs::path& file) {
  const fs::path sensor = file.parent_path().parent_path() / "cam0" / "sensor.yaml";
  const slam::Pose body_from_cam = read_body_from_cam(sensor);
  std::vector<TimedPose> poses;
  for (const ListLine& line : read_list_lines(file)) {
    const std::vector<double> v = numbers_of(split_at_commas(line), 8);
    if (v.empty() || std::hypot(v[4], v[5], std::hypot(v[6], v[7])) < 1e-6) {
      throw UserError(fmt::format("{}:{}: expected 'nanoseconds,x,y,z,qw,qx,qy,qz,...'",
                                  file.string(), line.number));
    }
    const slam::Pose world_from_body =
        pose_of({v[1], v[2], v[3]}, Eigen::Quaterniond(v[4], v[5], v[6], v[7]));
    poses.push_back({v[0] * 1e-9, world_from_body * body_from_cam});
  }
  return poses;
}

/// Nothing for a matrix of a frame that its makers could not locate.
std::optional<slam::Pose> read_matrix(const fs::path& file) {
  // Not a list: '#' begins no comment, but stands in "-1.#IND" of frames without a pose.
  std::ifstream in(file);
  std::vector<std::string> fields;
  for (std::string field; in >> field;) fields.push_back(field);
  if (fields.size() != 16) throw UserError(file.string() + ": expected a 4x4 matrix");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) {
    const auto value = parse_number(fields[static_cast<std::size_t>(i)]);
    if (!value) return std::nullopt;
    matrix(i / 4, i % 4) = *value;
  }
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  if ((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm() > kNearlyOrthonormal) {
    return std::nullopt;
  }
  return pose_of(matrix.topRightCorner<3, 1>(), Eigen::Quaterniond(rotation));
}

std::vector<TimedPose> read_seven_scenes(const fs::path& folder, double fps) {
  std::vector<TimedPose> poses;
  for (const NumberedFile& frame : numbered_files(folder, ".pose.txt")) {
    if (const auto pose = read_matrix(frame.file)) {
      poses.push_back({nominal_time(frame.number, fps), *pose});
    }
  }
  return poses;
}

bool is_icl(const fs::path& file) { return file.filename().string().ends_with(".gt.freiburg"); }

}  // namespace

std::vector<TimedPose> read_trajectory(const fs::path& file) {
  std::vector<TimedPose> poses;
  for (const ListLine& line : read_list_lines(file)) {
    const std::vector<double> value =
        line.fields.size() == 8 ? numbers_of(line, 8) : std::vector<double>();
    const bool good =
        !value.empty() && Eigen::Vector4d(value[4], value[5], value[6], value[7]).norm() >= 1e-6;
    if (!good) {
      throw UserError(fmt::format("{}:{}: expected 'timestamp tx ty tz qx qy qz qw'", file.string(),
                                  line.number));
    }
    poses.push_back(
        {value[0], pose_of({value[1], value[2], value[3]},
                           Eigen::Quaterniond(value[7], value[4], value[5], value[6]))});
  }
  return poses;
}

std::optional<fs::path> find_groundtruth(const fs::path& sequence) {
  std::error_code ignored;
  if (!fs::is_directory(sequence, ignored)) return std::nullopt;
  if (fs::exists(sequence / "groundtruth.txt")) return sequence / "groundtruth.txt";
  for (const char* folder : {"mav0", "."}) {
    const fs::path file = sequence / folder / "state_groundtruth_estimate0" / "data.csv";
    if (fs::exists(file)) return file.lexically_normal();
  }
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(sequence)) {
    if (is_icl(entry.path())) found.push_back(entry.path());
  }
  if (!found.empty()) return *std::min_element(found.begin(), found.end());
  if (!numbered_files(sequence, ".pose.txt").empty()) return sequence;
  return std::nullopt;
}

std::vector<TimedPose> read_groundtruth(const fs::path& file_or_folder, double fps) {
  fs::path file = file_or_folder;
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    const auto found = find_groundtruth(file);
    if (!found) throw UserError(file.string() + ": holds no true poses");
    file = *found;
  }
  std::vector<TimedPose> poses;
  if (fs::is_directory(file, ignored)) {
    poses = read_seven_scenes(file, fps);
  } else if (file.extension() == ".csv") {
    poses = read_euroc(file);
  } else {
    poses = read_trajectory(file);
    if (is_icl(file)) {
      for (TimedPose& pose : poses) pose.timestamp = nominal_time(pose.timestamp, fps);
    }
  }
  if (poses.empty()) throw UserError(file.string() + ": holds no true poses");
  std::stable_sort(poses.begin(), poses.end(), [](const TimedPose& a, const TimedPose& b) {
    return a.timestamp < b.timestamp;
  });
  return poses;
}

}  // namespace planecast::engine
