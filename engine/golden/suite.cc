#include "engine/golden/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/assets.h"
#include "engine/output/atomic_file.h"
#include "engine/scene/yaml_map.h"
#include "engine/sequence/camera_file.h"
#include "engine/sequence/frame_options.h"
#include "engine/sequence/made_sequence.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSuiteFile = "golden.yaml";
constexpr const char* kIgnoreFile = ".gitignore";

/// Checks an option's text by its own parser, with the line where it stands.
template <typename Check>
void check_text(const YamlMap& map, const std::string& key, const std::string& text, Check check) {
  if (text.empty()) return;
  try {
    check(text);
  } catch (const UserError& error) {
    map.fail(key, error.what());
  }
}

GoldenTolerance read_tolerance(YamlMap& parent, const GoldenTolerance& outer) {
  GoldenTolerance result = outer;
  std::optional<YamlMap> map = parent.map("tolerance");
  if (!map) return result;
  result.channel = map->integer("channel").value_or(outer.channel);
  result.share = map->number("share").value_or(outer.share);
  result.ssim = map->number("ssim").value_or(outer.ssim);
  if (result.channel < 0 || result.channel > 255) map->fail("channel", "'channel' is 0 to 255");
  if (result.share < 0.0 || result.share > 1.0) map->fail("share", "'share' is 0 to 1");
  if (result.ssim < -1.0 || result.ssim > 1.0) map->fail("ssim", "'ssim' is -1 to 1");
  map->finish();
  return result;
}

std::vector<int> read_frames(YamlMap& map) {
  const YAML::Node node = map.node("frames");
  std::set<int> frames;
  if (node && node.IsSequence()) {
    for (const YAML::Node& item : node) {
      int frame = -1;
      if (!item.IsScalar() || !YAML::convert<int>::decode(item, frame) || frame < 0) {
        map.fail("frames", "'frames' must list frame numbers");
      }
      frames.insert(frame);
    }
  }
  if (frames.empty()) map.fail("frames", "'frames' must list at least one frame number");
  return {frames.begin(), frames.end()};
}

class SuiteReader {
 public:
  explicit SuiteReader(const fs::path& folder) : file_(folder / kSuiteFile) {
    suite_.folder = folder;
  }

  GoldenSuite read();

 private:
  fs::path existing(YamlMap& map, const std::string& key) const;
  void read_input(YamlMap& map, GoldenCase& result) const;
  GoldenCase read_case(YamlMap map);

  fs::path file_;
  GoldenSuite suite_;
  GoldenTolerance tolerance_;
  std::set<std::string> names_;
};

/// A path of the file, from the suite's folder on; empty where the key is absent.
fs::path SuiteReader::existing(YamlMap& map, const std::string& key) const {
  const auto text = map.text(key);
  if (!text) return {};
  const fs::path path = suite_.folder / *text;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) map.fail(key, path.string() + ": no such file or folder");
  return path;
}

void SuiteReader::read_input(YamlMap& map, GoldenCase& result) const {
  result.sequence = existing(map, "sequence");
  result.synth = read_synth_options(map);
  if (result.sequence.empty() == !result.synth.has_value()) {
    map.fail("name", "a case needs either 'sequence' or 'synth'");
  }
  result.reconstruction = existing(map, "reconstruction");
  result.scene = existing(map, "scene");
  result.camera = map.text("camera").value_or("");
  const fs::path beside = suite_.folder / result.camera;
  std::error_code ignored;
  if (!result.camera.empty() && fs::is_regular_file(beside, ignored)) {
    result.camera = beside.string();
  }
  check_text(map, "camera", result.camera, load_camera);
}

GoldenCase SuiteReader::read_case(YamlMap map) {
  GoldenCase result;
  const auto name = map.text("name");
  if (!name) map.fail("name", "'name' is missing");
  if (*name != folder_name(*name) || name->front() == '.') {
    map.fail("name", "'" + *name + "': a case's name has letters, digits and - _ . alone");
  }
  if (!names_.insert(*name).second) map.fail("name", "the name '" + *name + "' stands twice");
  result.name = *name;
  read_input(map, result);
  result.size = map.text("size").value_or("");
  check_text(map, "size", result.size, parse_size);
  result.range = map.text("range").value_or("");
  SequenceOptions ignored;
  check_text(map, "range", result.range,
             [&ignored](const std::string& text) { parse_frames(text, ignored); });
  result.mode = map.choice("mode", {"mono", "rgbd", "auto"}).value_or(result.mode);
  result.segmentation = map.text("segmentation").value_or(result.segmentation);
  result.causal = map.boolean("causal").value_or(false);
  const int seed = map.integer("seed").value_or(1);
  if (seed < 0) map.fail("seed", "'seed' must not be negative");
  result.seed = static_cast<std::uint64_t>(seed);
  result.frames = read_frames(map);
  result.tolerance = read_tolerance(map, tolerance_);
  map.finish();
  return result;
}

GoldenSuite SuiteReader::read() {
  YamlMap root(load_yaml_file(file_), file_.string(), "the file");
  tolerance_ = read_tolerance(root, GoldenTolerance{});
  const YAML::Node cases = root.node("cases");
  if (!cases || !cases.IsSequence() || cases.size() == 0) {
    root.fail("cases", "'cases' must be a list of at least one case");
  }
  for (const YAML::Node& node : cases) {
    suite_.cases.push_back(read_case(YamlMap(node, file_.string(), "a case")));
  }
  root.finish();
  return suite_;
}

}  // namespace

fs::path golden_picture(const GoldenCase& golden_case, int frame) {
  return fs::path(golden_case.name) / fmt::format("{:06}.png", frame);
}

GoldenSuite read_golden_suite(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder / kSuiteFile, ignored)) {
    throw UserError(folder.string() + ": has no " + kSuiteFile + "; `planecast golden init " +
                    folder.string() + "` writes one");
  }
  return SuiteReader(folder).read();
}

void init_golden_suite(const fs::path& folder) {
  std::error_code ignored;
  if (fs::exists(folder / kSuiteFile, ignored)) {
    throw UserError((folder / kSuiteFile).string() + ": is there already");
  }
  make_folder(folder);
  if (!fs::exists(folder / kIgnoreFile, ignored)) write_file(folder / kIgnoreFile, "out/\n");
  write_file(folder / kSuiteFile, read_file(asset(std::string("golden/") + kSuiteFile)));
}

}  // namespace planecast::engine
