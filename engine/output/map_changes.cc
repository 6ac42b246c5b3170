#include "engine/output/map_changes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <sstream>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

constexpr const char* kHeader = "frame,kind,id,tx,ty,tz,qx,qy,qz,qw";

struct Line {
  int frame = 0;
  std::string kind;
  int id = 0;
  slam::Pose pose = slam::Pose::Identity();
};

std::string to_text(const Line& line) {
  const Eigen::Vector3d t = line.pose.translation();
  const Eigen::Quaterniond q(line.pose.linear());
  return fmt::format("{},{},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n",
                     line.frame, line.kind, line.id, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                     q.w());
}

std::optional<double> to_number(const std::string& field) {
  std::size_t used = 0;
  try {
    const double value = std::stod(field, &used);
    if (used == field.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {
  }
  return std::nullopt;
}

std::optional<Line> parse(const std::string& text) {
  std::istringstream in(text);
  Line line;
  std::vector<double> values;
  for (std::string field; std::getline(in, field, ',');) {
    if (values.size() == 1 && line.kind.empty()) {
      line.kind = field;
      continue;
    }
    const std::optional<double> value = to_number(field);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  if (values.size() != 9 || std::abs(values[0]) > 1e9 || std::abs(values[1]) > 1e9) {
    return std::nullopt;
  }
  const Eigen::Quaterniond q(values[8], values[5], values[6], values[7]);
  if (std::abs(q.norm() - 1.0) > 1e-3) return std::nullopt;
  line.frame = static_cast<int>(values[0]);
  line.id = static_cast<int>(values[1]);
  line.pose.linear() = q.normalized().toRotationMatrix();
  line.pose.translation() = Eigen::Vector3d(values[2], values[3], values[4]);
  return line;
}

/// Whether the line fits behind those before it.
bool add_line(const Line& line, std::vector<MapChange>& changes) {
  if (line.kind == "map") {
    changes.push_back({line.frame, line.pose, {}, {}});
    return true;
  }
  if (changes.empty() || changes.back().frame_index != line.frame) return false;
  if (line.kind == "plane") {
    changes.back().planes.push_back({line.id, line.pose});
  } else if (line.kind == "keyframe") {
    changes.back().keyframes.push_back({line.id, line.pose});
  } else {
    return false;
  }
  return true;
}

}  // namespace

void write_map_changes(const std::vector<MapChange>& changes, const std::filesystem::path& path) {
  std::string text = std::string(kHeader) + "\n";
  for (const MapChange& change : changes) {
    text += to_text({change.frame_index, "map", 0, change.new_from_old_world});
    for (const KnownPlane& plane : change.planes) {
      text += to_text({change.frame_index, "plane", plane.id, plane.world_from_plane});
    }
    for (const KnownKeyframe& keyframe : change.keyframes) {
      text +=
          to_text({change.frame_index, "keyframe", keyframe.frame_index, keyframe.world_from_cam});
    }
  }
  write_file(path, text);
}

std::vector<MapChange> read_map_changes(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  std::istringstream in(read_file(path));
  std::vector<MapChange> changes;
  std::string text;
  for (int number = 1; std::getline(in, text); ++number) {
    if (number == 1 && text == kHeader) continue;
    const std::optional<Line> line = parse(text);
    if (!line || !add_line(*line, changes)) {
      throw UserError(fmt::format("{}:{}: not a change of the map", path.string(), number));
    }
  }
  return changes;
}

}  // namespace planecast::engine
