#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace planecast::engine {

/// Checked access to one mapping of a YAML file. Every getter marks its key as known; finish()
/// refuses the keys nobody asked for. All failures are UserErrors of the form "file:LINE: reason".
class YamlMap {
 public:
  /// `what` names the mapping in messages ("object", "light").
  YamlMap(YAML::Node node, std::string file, std::string what);

  bool has(const std::string& key) const;
  /// The node of a key, or an undefined node.
  YAML::Node node(const std::string& key);

  std::optional<double> number(const std::string& key);
  /// A number above 0.
  std::optional<double> positive(const std::string& key);
  std::optional<int> integer(const std::string& key);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  /// One of `allowed`.
  std::optional<std::string> choice(const std::string& key,
                                    const std::vector<std::string>& allowed);
  /// A list of exactly `count` numbers.
  std::optional<std::vector<double>> numbers(const std::string& key, int count);
  std::optional<Eigen::Vector2d> vector2(const std::string& key);
  std::optional<Eigen::Vector3d> vector3(const std::string& key);
  std::optional<YamlMap> map(const std::string& key);

  /// Throws if a key was never asked for, or stands twice.
  void finish() const;

  /// Throws a UserError at the key's line (or the mapping's, when the key is absent).
  [[noreturn]] void fail(const std::string& key, const std::string& reason) const;
  int line() const;
  int line_of(const std::string& key) const;

 private:
  YAML::Node node_;
  std::string file_;
  std::string what_;
  std::set<std::string> known_;
};

/// The root of a YAML file. Throws UserError naming the file, and the line of a mistake.
YAML::Node load_yaml_file(const std::filesystem::path& file);

/// "file:LINE".
std::string yaml_location(const std::string& file, const YAML::Node& node);

}  // namespace planecast::engine
