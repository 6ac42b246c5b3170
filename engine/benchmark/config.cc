#include "engine/benchmark/config.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "engine/scene/yaml_map.h"
#include "engine/sequence/made_sequence.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

constexpr int kMostSeeds = 100;

/// Reads the parts of one file.
class ConfigReader {
 public:
  explicit ConfigReader(const fs::path& file) : file_(file), name_(file.string()) {}

  BenchmarkConfig read();

 private:
  std::vector<std::string> texts(YamlMap& map, const std::string& key) const;
  std::vector<std::string> choices(YamlMap& map, const std::string& key,
                                   const std::vector<std::string>& allowed) const;
  YAML::Node list(YamlMap& map, const std::string& key) const;
  std::vector<std::uint64_t> seeds(YamlMap& map) const;
  BenchmarkSequence sequence(YamlMap map) const;
  BenchmarkVariant variant(YamlMap map) const;
  std::vector<PublishedColumn> published() const;
  std::map<std::string, std::string> figures(YamlMap& map, const std::string& mode) const;
  std::string unique_name(YamlMap& map, std::set<std::string>& names) const;
  void check_variant_names(const BenchmarkConfig& config) const;

  fs::path file_;
  std::string name_;
  fs::path data_;
  std::vector<std::string> default_modes_;
};

YAML::Node ConfigReader::list(YamlMap& map, const std::string& key) const {
  const YAML::Node node = map.node(key);
  if (node && !node.IsSequence()) map.fail(key, "'" + key + "' must be a list");
  return node;
}

std::vector<std::string> ConfigReader::texts(YamlMap& map, const std::string& key) const {
  std::vector<std::string> result;
  for (const YAML::Node& item : list(map, key)) {
    if (!item.IsScalar() || item.Scalar().empty()) map.fail(key, "'" + key + "' must list texts");
    result.push_back(item.Scalar());
  }
  return result;
}

std::vector<std::string> ConfigReader::choices(YamlMap& map, const std::string& key,
                                               const std::vector<std::string>& allowed) const {
  const std::vector<std::string> result = texts(map, key);
  for (const std::string& item : result) {
    if (std::find(allowed.begin(), allowed.end(), item) != allowed.end()) continue;
    std::string known;
    for (const std::string& name : allowed) known += (known.empty() ? "" : ", ") + name;
    map.fail(key, "'" + item + "' in '" + key + "' is none of " + known);
  }
  return result;
}

const std::vector<std::string> kModes = {"mono", "rgbd", "auto"};

std::vector<std::uint64_t> ConfigReader::seeds(YamlMap& map) const {
  std::vector<std::uint64_t> result;
  const YAML::Node node = map.node("seeds");
  if (node && node.IsSequence()) {
    for (const YAML::Node& item : node) {
      std::uint64_t seed = 0;
      if (!item.IsScalar() || !YAML::convert<std::uint64_t>::decode(item, seed)) {
        map.fail("seeds", "'seeds' must list whole numbers");
      }
      result.push_back(seed);
    }
    if (result.empty()) map.fail("seeds", "'seeds' is empty");
    return result;
  }
  const int count = map.integer("seeds").value_or(1);
  if (count < 1 || count > kMostSeeds) map.fail("seeds", "'seeds' must be 1 to 100 or a list");
  for (int seed = 1; seed <= count; ++seed) result.push_back(static_cast<std::uint64_t>(seed));
  return result;
}

std::string ConfigReader::unique_name(YamlMap& map, std::set<std::string>& names) const {
  const auto name = map.text("name");
  if (!name) map.fail("name", "'name' is missing");
  if (!names.insert(*name).second) map.fail("name", "the name '" + *name + "' stands twice");
  return *name;
}

BenchmarkSequence ConfigReader::sequence(YamlMap map) const {
  BenchmarkSequence result;
  result.group = map.text("group").value_or("");
  result.camera = map.text("camera").value_or("");
  result.frames = map.text("frames").value_or("");
  result.size = map.text("size").value_or("");
  result.modes = choices(map, "modes", kModes);
  if (result.modes.empty()) result.modes = default_modes_;
  result.variants = texts(map, "variants");
  const auto path = map.text("path");
  result.synth = read_synth_options(map);
  if (path.has_value() == result.synth.has_value()) {
    map.fail("name", "a sequence needs either 'path' or 'synth'");
  }
  if (path) result.path = data_ / *path;
  if (const auto truth = map.text("groundtruth")) {
    if (!path) map.fail("groundtruth", "'groundtruth' belongs to a 'path'");
    result.groundtruth = result.path / *truth;
  }
  map.finish();
  return result;
}

BenchmarkVariant ConfigReader::variant(YamlMap map) const {
  BenchmarkVariant result;
  result.options = texts(map, "options");
  result.modes = choices(map, "modes", kModes);
  map.finish();
  return result;
}

std::map<std::string, std::string> ConfigReader::figures(YamlMap& map,
                                                         const std::string& mode) const {
  std::map<std::string, std::string> result;
  const YAML::Node node = map.node(mode);
  if (!node) return result;
  if (!node.IsMap()) map.fail(mode, "'" + mode + "' must map sequences to figures");
  for (const auto& entry : node) result[entry.first.Scalar()] = entry.second.Scalar();
  return result;
}

std::vector<PublishedColumn> ConfigReader::published() const {
  std::vector<PublishedColumn> columns;
  YamlMap root(load_yaml_file(file_), name_, "the file");
  for (const YAML::Node& node : list(root, "columns")) {
    YamlMap map(node, name_, "a column");
    PublishedColumn column;
    for (const auto& [key, member] :
         {std::pair{"name", &PublishedColumn::name}, std::pair{"source", &PublishedColumn::source},
          std::pair{"metric", &PublishedColumn::metric}}) {
      const auto value = map.text(key);
      if (!value) map.fail(key, std::string("'") + key + "' is missing");
      column.*member = *value;
    }
    for (const std::string mode : {"mono", "rgbd", "any"}) {
      column.figures[mode] = figures(map, mode);
    }
    map.finish();
    columns.push_back(std::move(column));
  }
  root.finish();
  return columns;
}

void ConfigReader::check_variant_names(const BenchmarkConfig& config) const {
  for (const BenchmarkSequence& sequence : config.sequences) {
    for (const std::string& wanted : sequence.variants) {
      const bool known =
          std::any_of(config.variants.begin(), config.variants.end(),
                      [&wanted](const BenchmarkVariant& v) { return v.name == wanted; });
      if (!known) {
        throw UserError(name_ + ": sequence '" + sequence.name + "': no variant '" + wanted + "'");
      }
    }
  }
}

BenchmarkConfig ConfigReader::read() {
  YamlMap root(load_yaml_file(file_), name_, "the file");
  BenchmarkConfig config;
  config.title = root.text("title").value_or(file_.stem().string());
  config.about = root.text("about").value_or("");
  config.seeds = seeds(root);
  config.options = texts(root, "options");
  config.tables = choices(root, "tables", benchmark_table_names());
  config.plots = choices(root, "plots", benchmark_plot_names());
  default_modes_ = choices(root, "modes", kModes);
  if (default_modes_.empty()) default_modes_ = {"auto"};
  const std::string variable = root.text("data").value_or("PLANECAST_DATASETS");
  const std::string fallback = root.text("data_default").value_or("");
  const char* given = std::getenv(variable.c_str());
  data_ = given != nullptr ? fs::path(given) : fs::path(fallback);
  for (const YAML::Node& node : list(root, "curves")) {
    YamlMap map(node, name_, "a curve");
    const auto x = map.text("x");
    const auto y = map.text("y");
    if (!x || !y) map.fail("x", "a curve needs x and y");
    map.finish();
    config.curves.push_back({*x, *y});
  }
  std::set<std::string> names;
  for (const YAML::Node& node : list(root, "variants")) {
    YamlMap map(node, name_, "a variant");
    const std::string name = unique_name(map, names);
    config.variants.push_back(variant(map));
    config.variants.back().name = name;
  }
  if (config.variants.empty()) config.variants.emplace_back();
  names.clear();
  for (const YAML::Node& node : list(root, "sequences")) {
    YamlMap map(node, name_, "a sequence");
    const std::string name = unique_name(map, names);
    config.sequences.push_back(sequence(map));
    config.sequences.back().name = name;
  }
  if (config.sequences.empty()) throw UserError(name_ + ": 'sequences' is missing or empty");
  if (const auto published = root.text("published")) {
    config.published = ConfigReader(file_.parent_path() / *published).published();
  }
  root.finish();
  check_variant_names(config);
  return config;
}

}  // namespace

const std::vector<std::string>& benchmark_table_names() {
  static const std::vector<std::string> names = {"ate",     "tracking", "planes",    "supported",
                                                 "overlay", "timings",  "resources", "ablation"};
  return names;
}

const std::vector<std::string>& benchmark_plot_names() {
  static const std::vector<std::string> names = {"ate", "trajectories"};
  return names;
}

BenchmarkConfig read_benchmark_config(const fs::path& file) { return ConfigReader(file).read(); }

}  // namespace planecast::engine
