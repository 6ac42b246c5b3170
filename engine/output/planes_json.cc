#include "engine/output/planes_json.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

using Json = nlohmann::ordered_json;
using Ring = std::vector<Eigen::Vector3d>;

Json to_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json to_json(const Ring& ring) {
  Json array = Json::array();
  for (const Eigen::Vector3d& vertex : ring) array.push_back(to_json(vertex));
  return array;
}

Json to_json(const PlaneRecord& plane) {
  Json holes = Json::array();
  for (const Ring& hole : plane.holes) holes.push_back(to_json(hole));
  Json json;
  json["id"] = plane.id;
  json["normal"] = to_json(plane.normal);
  json["offset"] = plane.offset;
  json["class"] = plane.plane_class;
  json["inliers"] = plane.inliers;
  json["rms"] = plane.rms;
  json["area"] = plane.area;
  json["polygon"] = to_json(plane.polygon);
  json["holes"] = std::move(holes);
  json["label"] = plane.label;
  json["first_frame"] = plane.first_frame;
  json["merged_from"] = plane.merged_from;
  json["origin"] = to_json(plane.origin);
  json["x_axis"] = to_json(plane.x_axis);
  return json;
}

/// Reads members of one JSON object; every failure names the file, the object and the key.
class ObjectReader {
 public:
  ObjectReader(const Json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object_.is_object()) fail("is not an object");
  }

  bool has(const char* key) const { return object_.contains(key); }
  const Json& at(const char* key) const {
    if (!has(key)) fail(fmt::format("has no \"{}\"", key));
    return object_.at(key);
  }
  double number(const char* key) const {
    if (!at(key).is_number()) fail(fmt::format("\"{}\" is not a number", key));
    return at(key).get<double>();
  }
  double number_or(const char* key, double fallback) const {
    return has(key) ? number(key) : fallback;
  }
  int integer(const char* key) const { return integer(at(key), key); }
  int integer_or(const char* key, int fallback) const { return has(key) ? integer(key) : fallback; }
  std::string text_or(const char* key, const std::string& fallback) const {
    if (!has(key)) return fallback;
    if (!at(key).is_string()) fail(fmt::format("\"{}\" is not a string", key));
    return at(key).get<std::string>();
  }
  Eigen::Vector3d vector(const char* key) const { return vector(at(key), key); }
  Ring ring_or_empty(const char* key) const { return has(key) ? ring(at(key), key) : Ring(); }
  std::vector<Ring> rings_or_empty(const char* key) const {
    std::vector<Ring> rings;
    if (!has(key)) return rings;
    for (const Json& item : array(at(key), key)) rings.push_back(ring(item, key));
    return rings;
  }
  std::vector<int> integers_or_empty(const char* key) const {
    std::vector<int> integers;
    if (!has(key)) return integers;
    for (const Json& item : array(at(key), key)) integers.push_back(integer(item, key));
    return integers;
  }
  const Json& array(const char* key) const { return array(at(key), key); }
  [[noreturn]] void fail(const std::string& reason) const {
    throw UserError(fmt::format("{} {}", where_, reason));
  }

 private:
  int integer(const Json& value, const char* key) const {
    if (!value.is_number_integer()) fail(fmt::format("\"{}\" is not a whole number", key));
    return value.get<int>();
  }
  const Json& array(const Json& value, const char* key) const {
    if (!value.is_array()) fail(fmt::format("\"{}\" is not an array", key));
    return value;
  }
  Eigen::Vector3d vector(const Json& value, const char* key) const {
    if (array(value, key).size() != 3) fail(fmt::format("\"{}\" needs 3 numbers", key));
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i) {
      const Json& component = value.at(static_cast<std::size_t>(i));
      if (!component.is_number()) fail(fmt::format("\"{}\" needs 3 numbers", key));
      v[i] = component.get<double>();
    }
    return v;
  }
  Ring ring(const Json& value, const char* key) const {
    Ring ring;
    for (const Json& vertex : array(value, key)) ring.push_back(vector(vertex, key));
    return ring;
  }

  const Json& object_;
  std::string where_;
};

/// Where a file names no frame of the plane: origin at the mean of the outline.
void default_frame(PlaneRecord& plane) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& vertex : plane.polygon) mean += vertex;
  if (!plane.polygon.empty()) mean /= static_cast<double>(plane.polygon.size());
  plane.origin = mean - (plane.normal.dot(mean) + plane.offset) * plane.normal;
  plane.x_axis = plane.normal.unitOrthogonal();
}

PlaneRecord read_plane(const ObjectReader& json) {
  PlaneRecord plane;
  plane.id = json.integer("id");
  plane.normal = json.vector("normal");
  plane.offset = json.number("offset");
  const double norm = plane.normal.norm();
  if (!(norm > 1e-9) || !std::isfinite(norm)) json.fail("\"normal\" has no direction");
  // Dividing by a norm that is 1 but for rounding would change digits that were read exactly.
  if (std::abs(norm - 1.0) > 1e-12) {
    plane.normal /= norm;
    plane.offset /= norm;
  }
  plane.plane_class = json.text_or("class", plane.plane_class);
  plane.inliers = json.integer_or("inliers", 0);
  plane.rms = json.number_or("rms", 0.0);
  plane.area = json.number_or("area", 0.0);
  plane.polygon = json.ring_or_empty("polygon");
  plane.holes = json.rings_or_empty("holes");
  plane.label = json.integer_or("label", 0);
  plane.first_frame = json.integer_or("first_frame", 0);
  plane.merged_from = json.integers_or_empty("merged_from");
  default_frame(plane);
  if (json.has("origin")) plane.origin = json.vector("origin");
  if (json.has("x_axis")) plane.x_axis = json.vector("x_axis");
  return plane;
}

Json parse(const std::filesystem::path& path) {
  try {
    return Json::parse(read_file(path));
  } catch (const Json::parse_error& error) {
    throw UserError(fmt::format("{}: is not valid JSON at byte {}", path.string(), error.byte));
  } catch (const Json::exception&) {
    throw UserError(fmt::format("{}: is not valid JSON", path.string()));
  }
}

}  // namespace

std::string planes_json_text(const PlaneSet& set) {
  Json planes = Json::array();
  for (const PlaneRecord& plane : set.planes) planes.push_back(to_json(plane));
  Json json;
  json["units"] = set.metric ? "metres" : "map";
  json["planes"] = std::move(planes);
  json["up"] = to_json(set.up);
  json["up_confidence"] = set.up_confidence;
  return json.dump(1) + "\n";
}

void write_planes_json(const PlaneSet& set, const std::filesystem::path& path) {
  write_file(path, planes_json_text(set));
}

PlaneSet read_planes_json(const std::filesystem::path& path) {
  const Json json = parse(path);
  const ObjectReader file(json, path.string() + ":");
  PlaneSet set;
  const std::string units = file.text_or("units", "map");
  if (units != "metres" && units != "map") {
    file.fail(fmt::format("\"units\" is neither \"metres\" nor \"map\""));
  }
  set.metric = units == "metres";
  std::set<int> ids;
  for (const Json& item : file.array("planes")) {
    const ObjectReader reader(item,
                              fmt::format("{}: plane {} of the list", path.string(), ids.size()));
    set.planes.push_back(read_plane(reader));
    if (!ids.insert(set.planes.back().id).second) reader.fail("has the id of another");
  }
  if (file.has("up")) set.up = file.vector("up");
  if (!(set.up.norm() > 1e-9)) file.fail("\"up\" has no direction");
  set.up_confidence = file.number_or("up_confidence", 0.0);
  return set;
}

}  // namespace planecast::engine
