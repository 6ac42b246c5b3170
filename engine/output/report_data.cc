#include "engine/output/report_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "engine/output/base64.h"
#include "engine/output/report_mesh.h"
#include "engine/output/report_svg.h"
#include "engine/scene/plane_outline.h"

namespace planecast::engine {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxPoints = 30000;

/// Six digits are more than a screen shows and keep the page small.
Json number(double value) {
  return std::isfinite(value) ? Json(std::stod(fmt::format("{:.6g}", value))) : Json(0.0);
}

template <typename Vector>
Json numbers(const Vector& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(number(value));
  return json;
}

Json projection_json(const slam::Camera& camera) {
  return {{"width", camera.width},   {"height", camera.height}, {"fx", number(camera.fx)},
          {"fy", number(camera.fy)}, {"cx", number(camera.cx)}, {"cy", number(camera.cy)}};
}

Json pose_json(const std::optional<slam::Pose>& pose) {
  if (!pose) return nullptr;
  const Eigen::Quaterniond rotation(pose->linear());
  Json json = numbers(pose->translation());
  for (const double value : rotation.coeffs()) json.push_back(number(value));
  return json;
}

/// Position of `word` in `words`, at whose end it is put when it is new.
int index_in(Json& words, const std::string& word) {
  const auto found = std::find(words.begin(), words.end(), Json(word));
  if (found != words.end()) return static_cast<int>(found - words.begin());
  words.push_back(word);
  return static_cast<int>(words.size()) - 1;
}

void add_frames(const Reconstruction& reconstruction, Json& json) {
  Json frames = {{"index", Json::array()},
                 {"inliers", Json::array()},
                 {"state", Json::array()},
                 {"reason", Json::array()},
                 {"pose", Json::array()}};
  Json states = Json::array();
  Json reasons = Json::array();
  for (const FrameRecord& frame : reconstruction.frames) {
    frames["index"].push_back(frame.index);
    frames["inliers"].push_back(frame.inliers);
    frames["state"].push_back(index_in(states, frame.state));
    frames["reason"].push_back(index_in(reasons, frame.reason));
    frames["pose"].push_back(pose_json(frame.world_from_cam));
  }
  json["frames"] = std::move(frames);
  json["states"] = std::move(states);
  json["reasons"] = std::move(reasons);
  Json keyframes = Json::array();
  for (const KeyframeRecord& keyframe : reconstruction.keyframes) {
    keyframes.push_back(keyframe.frame_index);
  }
  json["keyframes"] = std::move(keyframes);
}

Json ring_json(const std::vector<Eigen::Vector2d>& ring) {
  Json json = Json::array();
  for (const Eigen::Vector2d& corner : ring) json.push_back(numbers(corner));
  return json;
}

Json plane_json(const PlaneRecord& plane) {
  const PlaneOutline outline = plane_outline(plane);
  const slam::Pose world_from_plane = plane.world_from_plane();
  Json json = {{"id", plane.id},
               {"class", plane.plane_class},
               {"color", plane_color_css(plane.id)},
               {"origin", numbers(world_from_plane.translation())},
               {"x", numbers(Eigen::Vector3d(world_from_plane.linear().col(0)))},
               {"y", numbers(Eigen::Vector3d(world_from_plane.linear().col(1)))},
               {"outer", ring_json(outline.outer)},
               {"holes", Json::array()}};
  for (const auto& hole : outline.holes) json["holes"].push_back(ring_json(hole));
  return json;
}

template <typename T>
void append_bytes(T value, std::string& bytes) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

Json points_json(const std::vector<MapPoint>& points) {
  std::string positions;
  std::string colors;
  std::string planes;
  const std::size_t step = points.size() / (kMaxPoints + 1) + 1;
  int count = 0;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const MapPoint& point = points[i];
    if (!point.position.allFinite()) continue;
    ++count;
    append_bytes(static_cast<std::int16_t>(std::min(point.plane, 32767)), planes);
    for (int k = 0; k < 3; ++k) {
      append_bytes(static_cast<float>(point.position[k]), positions);
      append_bytes(static_cast<std::uint8_t>(std::clamp(point.color_rgb[k], 0.0F, 255.0F)), colors);
    }
  }
  return {{"count", count},
          {"position", base64(positions)},
          {"color", base64(colors)},
          {"plane", base64(planes)}};
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

Json mesh_json(const ObjectRecord& object) {
  if (!object.model) return nullptr;
  const ReportMesh mesh = report_mesh(*object.model);
  if (mesh.triangles.empty()) return nullptr;
  return {{"position", base64(bytes_of(mesh.positions))},
          {"color", base64(bytes_of(mesh.colors_srgb))},
          {"triangles", base64(bytes_of(mesh.triangles))}};
}

Json object_json(const ObjectRecord& object) {
  return {{"name", object.name},
          {"plane", object.plane},
          {"matrix", numbers(object.world_from_model.matrix().reshaped())},
          {"min", numbers(object.box.min())},
          {"max", numbers(object.box.max())},
          {"mesh", mesh_json(object)}};
}

}  // namespace

std::string script_json(const std::string& json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string report_data_json(const Reconstruction& reconstruction, const ReportInput& input) {
  Json json;
  json["units"] = reconstruction.metric ? "m" : "map units";
  json["fps"] = number(input.fps);
  json["camera"] = projection_json(reconstruction.camera);
  json["up"] = numbers(reconstruction.up);
  add_frames(reconstruction, json);
  json["planes"] = Json::array();
  for (const PlaneRecord& plane : reconstruction.planes) {
    json["planes"].push_back(plane_json(plane));
  }
  json["points"] = points_json(reconstruction.points);
  json["objects"] = Json::array();
  for (const ObjectRecord& object : input.objects) json["objects"].push_back(object_json(object));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace planecast::engine
