#include "engine/segmentation/network_file.h"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iterator>
#include <vector>

#include "engine/scene/yaml_map.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

namespace fs = std::filesystem;

constexpr int kLargestSide = 4096;

void read_input(YamlMap& map, slam::NetworkDescription& description) {
  std::optional<YamlMap> input = map.map("input");
  if (!input) map.fail("input", "input is missing");
  description.input = input->text("name").value_or("");
  description.size.width = input->integer("width").value_or(0);
  description.size.height = input->integer("height").value_or(0);
  for (const char* side : {"width", "height"}) {
    const int value = side[0] == 'w' ? description.size.width : description.size.height;
    if (value < 8 || value > kLargestSide) {
      input->fail(side, std::string(side) + " of the input: expected 8 to 4096 pixels");
    }
  }
  description.rgb = input->choice("colors", {"rgb", "bgr"}).value_or("rgb") == "rgb";
  if (const auto mean = input->numbers("mean", 3)) {
    description.mean = {(*mean)[0], (*mean)[1], (*mean)[2]};
  }
  if (const auto deviation = input->numbers("deviation", 3)) {
    description.deviation = {(*deviation)[0], (*deviation)[1], (*deviation)[2]};
    for (const double value : *deviation) {
      if (value <= 0.0) input->fail("deviation", "deviation: expected numbers above 0");
    }
  }
  input->finish();
}

double share(YamlMap& map, const char* key, double otherwise) {
  const double value = map.number(key).value_or(otherwise);
  if (value < 0.0 || value > 1.0) map.fail(key, std::string(key) + ": expected 0 to 1");
  return value;
}

}  // namespace

slam::NetworkDescription read_network_description(const fs::path& file) {
  YAML::Node root;
  try {
    root = YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw UserError(file.string() + ": cannot be read; a network needs its description there");
  } catch (const YAML::Exception& error) {
    throw UserError(file.string() + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
  YamlMap map(root, file.string(), "the description");
  slam::NetworkDescription description;
  description.name = map.text("name").value_or(file.stem().string());
  description.version = map.text("version").value_or("0");
  const bool maps = map.choice("kind", {"maps", "instances"}).value_or("instances") == "maps";
  description.kind =
      maps ? slam::NetworkDescription::Kind::kMaps : slam::NetworkDescription::Kind::kInstances;
  read_input(map, description);
  if (maps) {
    description.output = map.text("output").value_or("");
  } else {
    description.masks = map.text("masks").value_or("masks");
    description.scores = map.text("scores").value_or("scores");
    description.min_score = share(map, "min_score", description.min_score);
    description.min_mask = share(map, "min_mask", description.min_mask);
  }
  description.decode.min_share = share(map, "min_share", description.decode.min_share);
  map.finish();
  return description;
}

std::unique_ptr<slam::PlaneSegmenter> read_network(const fs::path& onnx) {
  std::ifstream in(onnx, std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(in),
                                         std::istreambuf_iterator<char>()};
  if (!in || bytes.empty()) throw UserError(onnx.string() + ": cannot be read");
  fs::path description = onnx;
  description.replace_extension(".yaml");
  slam::LoadedNetwork network = slam::load_network(bytes, read_network_description(description));
  if (network.segmenter == nullptr) throw UserError(onnx.string() + ": " + network.error);
  return std::move(network.segmenter);
}

}  // namespace planecast::engine
