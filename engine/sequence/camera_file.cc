#include "engine/sequence/camera_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "engine/output/atomic_file.h"
#include "engine/user_error.h"

namespace planecast::engine {

namespace fs = std::filesystem;

namespace {

struct Preset {
  const char* name;
  int width, height;
  double fx, fy, cx, cy;
  std::array<double, 5> distortion;
  double depth_factor;
  bool nominal = false;  ///< not calibrated: the focal length is to be refined
};

// TUM: Sturm et al. 2012, calibration of the ROS default set; ICL-NUIM: Handa et al. 2014;
// EuRoC: Burri et al. 2016, cam0's sensor.yaml; 7-Scenes: Shotton et al. 2013.
constexpr Preset kPresets[] = {
    {"tum-fr1",
     640,
     480,
     517.3,
     516.5,
     318.6,
     255.3,
     {0.2624, -0.9531, -0.0054, 0.0026, 1.1633},
     5000.0},
    {"tum-fr2",
     640,
     480,
     520.9,
     521.0,
     325.1,
     249.7,
     {0.2312, -0.7849, -0.0033, -0.0001, 0.9172},
     5000.0},
    {"tum-fr3", 640, 480, 535.4, 539.2, 320.1, 247.6, {}, 5000.0},
    {"icl-nuim", 640, 480, 481.20, -480.00, 319.50, 239.50, {}, 5000.0},
    {"euroc-cam0",
     752,
     480,
     458.654,
     457.296,
     367.215,
     248.375,
     {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0},
     5000.0},
    {"7scenes", 640, 480, 525.0, 525.0, 320.0, 240.0, {}, 1000.0, true},
};

// Accepted shape difference: a sensor's width and height are whole pixels at both sizes.
constexpr double kMaxAspectDifference = 0.01;

[[noreturn]] void fail(const fs::path& file, const std::string& reason) {
  throw UserError(fmt::format("{}: {}", file.string(), reason));
}

/// The text without a byte order mark and OpenCV's "%YAML:1.0", which is not a YAML directive.
std::string read_yaml_text(const fs::path& file) {
  std::string yaml = read_file(file);
  if (yaml.starts_with("\xEF\xBB\xBF")) yaml.erase(0, 3);
  if (yaml.starts_with("%YAML")) yaml.erase(0, std::min(yaml.find('\n'), yaml.size()));
  return yaml;
}

double number(const fs::path& file, const YAML::Node& node, const std::string& key) {
  double value = 0.0;
  try {
    value = node.as<double>();
  } catch (const YAML::Exception&) {
    fail(file, fmt::format("'{}' must be a number", key));
  }
  if (!std::isfinite(value)) fail(file, fmt::format("'{}' must be finite", key));
  return value;
}

std::vector<double> numbers(const fs::path& file, const YAML::Node& node, const std::string& key) {
  // A matrix of OpenCV or ROS is a map with the values in `data`.
  const YAML::Node list = node.IsMap() && node["data"] ? node["data"] : node;
  if (!list.IsSequence()) fail(file, fmt::format("'{}' must be a list of numbers", key));
  std::vector<double> values;
  for (const YAML::Node& entry : list) values.push_back(number(file, entry, key));
  return values;
}

int whole_number(const fs::path& file, const YAML::Node& node, const std::string& key) {
  const double value = number(file, node, key);
  if (value != std::floor(value) || value < 1 || value > 1e6) {
    fail(file, fmt::format("'{}' must be a positive whole number", key));
  }
  return static_cast<int>(value);
}

slam::LensModel lens_model(const fs::path& file, const std::string& name) {
  static const std::set<std::string> pinhole = {"pinhole", "plumb_bob", "rational_polynomial",
                                                "radial-tangential", "radtan"};
  static const std::set<std::string> fisheye = {"fisheye", "equidistant", "kannala-brandt"};
  if (pinhole.contains(name)) return slam::LensModel::kPinhole;
  if (fisheye.contains(name)) return slam::LensModel::kFisheye;
  fail(file, fmt::format("unknown camera model '{}' (pinhole or fisheye)", name));
}

void set_distortion(const fs::path& file, const std::vector<double>& values, slam::Camera& camera) {
  const std::size_t used = camera.lens == slam::LensModel::kFisheye ? 4 : 5;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i < used) camera.distortion[i] = values[i];
    if (i >= used && values[i] != 0.0) {
      fail(file, fmt::format("more than {} distortion coefficients are not supported", used));
    }
  }
}

CameraSettings parse_own(const fs::path& file, const YAML::Node& root) {
  static const std::set<std::string> known = {
      "model", "width", "height", "fx", "fy", "cx", "cy", "distortion", "fps", "depth_factor"};
  for (const auto& entry : root) {
    const std::string key = entry.first.as<std::string>();
    if (!known.contains(key)) fail(file, fmt::format("unknown key '{}'", key));
  }
  for (const char* key : {"width", "height", "fx", "fy", "cx", "cy"}) {
    if (!root[key]) fail(file, fmt::format("'{}' is missing", key));
  }
  CameraSettings settings;
  slam::Camera& camera = settings.camera;
  if (root["model"]) camera.lens = lens_model(file, root["model"].as<std::string>());
  camera.width = whole_number(file, root["width"], "width");
  camera.height = whole_number(file, root["height"], "height");
  camera.fx = number(file, root["fx"], "fx");
  camera.fy = number(file, root["fy"], "fy");
  camera.cx = number(file, root["cx"], "cx");
  camera.cy = number(file, root["cy"], "cy");
  if (root["distortion"]) {
    set_distortion(file, numbers(file, root["distortion"], "distortion"), camera);
  }
  return settings;
}

YAML::Node first_of(const YAML::Node& root, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (root[key]) return root[key];
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

CameraSettings parse_calibration(const fs::path& file, const YAML::Node& root) {
  CameraSettings settings;
  slam::Camera& camera = settings.camera;
  const YAML::Node model = first_of(root, {"distortion_model", "model"});
  if (model) camera.lens = lens_model(file, model.as<std::string>());
  if (root["fisheye_model"] && number(file, root["fisheye_model"], "fisheye_model") != 0.0) {
    camera.lens = slam::LensModel::kFisheye;
  }
  const std::vector<double> k = numbers(file, root["camera_matrix"], "camera_matrix");
  if (k.size() != 9) fail(file, "'camera_matrix' must have 9 values");
  camera.fx = k[0];
  camera.fy = k[4];
  camera.cx = k[2];
  camera.cy = k[5];
  const YAML::Node width = first_of(root, {"image_width", "image_Width", "img_width", "width"});
  const YAML::Node height =
      first_of(root, {"image_height", "image_Height", "img_height", "height"});
  if (width && height) {  // left out: the images' own size
    camera.width = whole_number(file, width, "image_width");
    camera.height = whole_number(file, height, "image_height");
  }
  const YAML::Node distortion = first_of(root, {"distortion_coefficients", "dist_coeffs"});
  if (distortion) {
    set_distortion(file, numbers(file, distortion, "distortion_coefficients"), camera);
  }
  return settings;
}

CameraSettings parse_euroc(const fs::path& file, const YAML::Node& root) {
  CameraSettings settings;
  slam::Camera& camera = settings.camera;
  if (root["distortion_model"]) {
    std::string name = root["distortion_model"].as<std::string>();
    camera.lens = lens_model(file, name);
  }
  const std::vector<double> k = numbers(file, root["intrinsics"], "intrinsics");
  if (k.size() != 4) fail(file, "'intrinsics' must have 4 values");
  camera.fx = k[0];
  camera.fy = k[1];
  camera.cx = k[2];
  camera.cy = k[3];
  if (root["resolution"]) {
    const std::vector<double> size = numbers(file, root["resolution"], "resolution");
    if (size.size() != 2) fail(file, "'resolution' must have 2 values");
    camera.width = whole_number(file, root["resolution"][0], "resolution");
    camera.height = whole_number(file, root["resolution"][1], "resolution");
  }
  if (root["distortion_coefficients"]) {
    set_distortion(file, numbers(file, root["distortion_coefficients"], "distortion_coefficients"),
                   camera);
  }
  return settings;
}

}  // namespace

std::vector<std::string> camera_preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

std::optional<CameraSettings> camera_preset(const std::string& name) {
  for (const Preset& preset : kPresets) {
    if (name != preset.name) continue;
    CameraSettings settings;
    settings.camera.width = preset.width;
    settings.camera.height = preset.height;
    settings.camera.fx = preset.fx;
    settings.camera.fy = preset.fy;
    settings.camera.cx = preset.cx;
    settings.camera.cy = preset.cy;
    settings.camera.distortion = preset.distortion;
    settings.depth_factor = preset.depth_factor;
    settings.camera.guessed = preset.nominal;
    return settings;
  }
  return std::nullopt;
}

CameraSettings load_camera(const std::string& preset_or_file) {
  if (auto preset = camera_preset(preset_or_file)) return *preset;
  std::error_code ignored;
  if (!fs::exists(preset_or_file, ignored)) {
    throw UserError(fmt::format("{}: no such camera file, and not a preset ({})", preset_or_file,
                                fmt::join(camera_preset_names(), ", ")));
  }
  return read_camera_file(preset_or_file);
}

CameraSettings read_camera_file(const fs::path& file) {
  CameraSettings settings;
  try {
    const YAML::Node root = YAML::Load(read_yaml_text(file));
    if (!root.IsMap()) fail(file, "not a camera file (expected 'key: value' lines)");
    if (root["camera_matrix"]) {
      settings = parse_calibration(file, root);
    } else if (root["intrinsics"]) {
      settings = parse_euroc(file, root);
    } else {
      settings = parse_own(file, root);
    }
    if (root["fps"]) settings.fps = number(file, root["fps"], "fps");
    if (root["depth_factor"]) {
      settings.depth_factor = number(file, root["depth_factor"], "depth_factor");
    }
  } catch (const YAML::Exception& error) {
    const std::string where =
        error.mark.is_null() ? "" : fmt::format(" in line {}", error.mark.line + 1);
    fail(file, fmt::format("not valid YAML{}: {}", where, error.msg));
  }
  const slam::Camera& camera = settings.camera;
  if (camera.fx <= 0.0) fail(file, "'fx' must be positive");
  if (camera.fy == 0.0) fail(file, "'fy' must not be 0");
  if (settings.fps && *settings.fps <= 0.0) fail(file, "'fps' must be positive");
  if (settings.depth_factor <= 0.0) fail(file, "'depth_factor' must be positive");
  return settings;
}

slam::Pose read_body_from_cam(const fs::path& file) {
  try {
    const YAML::Node root = YAML::Load(read_yaml_text(file));
    if (!root.IsMap() || !root["T_BS"]) fail(file, "'T_BS' is missing");
    const std::vector<double> t = numbers(file, root["T_BS"], "T_BS");
    if (t.size() != 16) fail(file, "'T_BS' must have 16 values");
    slam::Pose pose = slam::Pose::Identity();
    for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = t[static_cast<std::size_t>(i)];
    return pose;
  } catch (const YAML::Exception& error) {
    fail(file, "not valid YAML: " + error.msg);
  }
}

void write_camera_file(const fs::path& file, const CameraSettings& settings,
                       const std::string& comment) {
  const slam::Camera& camera = settings.camera;
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  const bool fisheye = camera.lens == slam::LensModel::kFisheye;
  text += fmt::format("model: {}\nwidth: {}\nheight: {}\n", fisheye ? "fisheye" : "pinhole",
                      camera.width, camera.height);
  text +=
      fmt::format("fx: {}\nfy: {}\ncx: {}\ncy: {}\n", camera.fx, camera.fy, camera.cx, camera.cy);
  if (camera.has_distortion()) {
    const auto end = camera.distortion.begin() + (fisheye ? 4 : 5);
    text += fmt::format("distortion: [{}]\n", fmt::join(camera.distortion.begin(), end, ", "));
  }
  if (settings.fps) text += fmt::format("fps: {}\n", *settings.fps);
  text += fmt::format("depth_factor: {}\n", settings.depth_factor);
  write_file(file, text);
}

nlohmann::ordered_json camera_json(const slam::Camera& camera) {
  nlohmann::ordered_json json;
  json["model"] = camera.lens == slam::LensModel::kFisheye ? "fisheye" : "pinhole";
  json["width"] = camera.width;
  json["height"] = camera.height;
  json["fx"] = camera.fx;
  json["fy"] = camera.fy;
  json["cx"] = camera.cx;
  json["cy"] = camera.cy;
  json["distortion"] = camera.distortion;
  json["guessed"] = camera.guessed;
  return json;
}

slam::Camera fit_camera_to_images(const slam::Camera& camera, int width, int height,
                                  const std::string& camera_name) {
  if (camera.width == 0 || camera.height == 0) {
    slam::Camera sized = camera;
    sized.width = width;
    sized.height = height;
    return sized;
  }
  if (camera.width == width && camera.height == height) return camera;
  const double aspect_ratio =
      (static_cast<double>(camera.width) * height) / (static_cast<double>(camera.height) * width);
  if (std::abs(aspect_ratio - 1.0) > kMaxAspectDifference) {
    throw UserError(fmt::format("{}: the camera is {}x{}, but the images are {}x{}", camera_name,
                                camera.width, camera.height, width, height));
  }
  return camera.scaled_to(width, height);
}

}  // namespace planecast::engine
