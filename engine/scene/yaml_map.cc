#include "engine/scene/yaml_map.h"

#include <cmath>
#include <utility>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

/// The reading of one scalar, or nothing when it is no such thing. yaml-cpp takes "nan" and ".inf"
/// for numbers; nothing in our files may be that.
std::optional<double> to_number(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  double value = 0.0;
  if (!YAML::convert<double>::decode(node, value) || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

YAML::Node load_yaml_file(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw UserError(file.string() + line + ": not valid YAML: " + error.msg);
  }
}

std::string yaml_location(const std::string& file, const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
}

YamlMap::YamlMap(YAML::Node node, std::string file, std::string what)
    : node_(std::move(node)), file_(std::move(file)), what_(std::move(what)) {
  if (!node_.IsMap()) {
    throw UserError(yaml_location(file_, node_) + ": " + what_ +
                    " must be a mapping of keys to values");
  }
}

bool YamlMap::has(const std::string& key) const {
  const YAML::Node& node = node_;
  return static_cast<bool>(node[key]);
}

YAML::Node YamlMap::node(const std::string& key) {
  known_.insert(key);
  const YAML::Node& node = node_;
  return node[key];
}

int YamlMap::line() const { return node_.Mark().line + 1; }

int YamlMap::line_of(const std::string& key) const {
  for (const auto& entry : node_) {
    if (entry.first.IsScalar() && entry.first.Scalar() == key) return entry.first.Mark().line + 1;
  }
  return line();
}

void YamlMap::fail(const std::string& key, const std::string& reason) const {
  throw UserError(file_ + ":" + std::to_string(line_of(key)) + ": " + reason);
}

std::optional<double> YamlMap::number(const std::string& key) {
  const YAML::Node value = node(key);
  if (!value) return std::nullopt;
  const std::optional<double> result = to_number(value);
  if (!result) fail(key, "'" + key + "' must be a number");
  return result;
}

std::optional<double> YamlMap::positive(const std::string& key) {
  const std::optional<double> result = number(key);
  if (result && *result <= 0.0) fail(key, "'" + key + "' must be positive");
  return result;
}

std::optional<int> YamlMap::integer(const std::string& key) {
  const YAML::Node value = node(key);
  if (!value) return std::nullopt;
  int result = 0;
  if (!value.IsScalar() || !YAML::convert<int>::decode(value, result)) {
    fail(key, "'" + key + "' must be a whole number");
  }
  return result;
}

std::optional<bool> YamlMap::boolean(const std::string& key) {
  const YAML::Node value = node(key);
  if (!value) return std::nullopt;
  bool result = false;
  if (!value.IsScalar() || !YAML::convert<bool>::decode(value, result)) {
    fail(key, "'" + key + "' must be true or false");
  }
  return result;
}

std::optional<std::string> YamlMap::text(const std::string& key) {
  const YAML::Node value = node(key);
  if (!value) return std::nullopt;
  if (!value.IsScalar() || value.Scalar().empty()) fail(key, "'" + key + "' must be a text");
  return value.Scalar();
}

std::optional<std::string> YamlMap::choice(const std::string& key,
                                           const std::vector<std::string>& allowed) {
  const YAML::Node value = node(key);
  if (!value) return std::nullopt;
  std::string list;
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    if (value.IsScalar() && value.Scalar() == allowed[i]) return allowed[i];
    list += (i == 0 ? "" : i + 1 == allowed.size() ? " or " : ", ") + allowed[i];
  }
  fail(key, "'" + key + "' must be " + list);
}

std::optional<std::vector<double>> YamlMap::numbers(const std::string& key, int count) {
  const YAML::Node value = node(key);
  if (!value) return std::nullopt;
  std::vector<double> result;
  if (value.IsSequence() && static_cast<int>(value.size()) == count) {
    for (const auto& item : value) {
      const std::optional<double> number = to_number(item);
      if (!number) break;
      result.push_back(*number);
    }
  }
  if (static_cast<int>(result.size()) != count) {
    fail(key, "'" + key + "' must be a list of " + std::to_string(count) + " numbers");
  }
  return result;
}

std::optional<Eigen::Vector2d> YamlMap::vector2(const std::string& key) {
  const std::optional<std::vector<double>> values = numbers(key, 2);
  if (!values) return std::nullopt;
  return Eigen::Vector2d((*values)[0], (*values)[1]);
}

std::optional<Eigen::Vector3d> YamlMap::vector3(const std::string& key) {
  const std::optional<std::vector<double>> values = numbers(key, 3);
  if (!values) return std::nullopt;
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<YamlMap> YamlMap::map(const std::string& key) {
  const YAML::Node value = node(key);
  if (!value) return std::nullopt;
  return YamlMap(value, file_, "'" + key + "'");
}

void YamlMap::finish() const {
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    const std::string where = yaml_location(file_, entry.first);
    if (known_.count(key) == 0) throw UserError(where + ": unknown key '" + key + "'");
    if (!seen.insert(key).second) throw UserError(where + ": key '" + key + "' stands twice");
  }
}

}  // namespace planecast::engine
