#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::engine {

/// What a camera file or a preset says about a recording.
struct CameraSettings {
  slam::Camera camera;
  std::optional<double> fps;     ///< only used where the input has no timestamps
  double depth_factor = 5000.0;  ///< depth image units per metre; 5000 is TUM RGB-D's
};

/// Names of the built-in cameras of public data sets.
std::vector<std::string> camera_preset_names();
std::optional<CameraSettings> camera_preset(const std::string& name);

/// A preset's name or a file. Throws UserError naming the file, the line or key, and the reason.
CameraSettings load_camera(const std::string& preset_or_file);

/// Reads our own format (see write_camera_file), OpenCV's and ROS's calibration files
/// (camera_matrix, distortion_coefficients) and EuRoC's sensor.yaml.
CameraSettings read_camera_file(const std::filesystem::path& file);

/// EuRoC's T_BS of a sensor.yaml: the camera's pose in the body's frame. Throws UserError.
slam::Pose read_body_from_cam(const std::filesystem::path& file);

/// Writes model, width, height, fx, fy, cx, cy, distortion, fps, depth_factor as YAML, below a
/// comment of any number of lines. Throws UserError where it cannot be written.
void write_camera_file(const std::filesystem::path& file, const CameraSettings& settings,
                       const std::string& comment = "");

/// Model, size, intrinsics, distortion and whether they are a guess.
nlohmann::ordered_json camera_json(const slam::Camera& camera);

/// The camera for images of the given size: scaled where only the size differs. Throws UserError
/// when the shape differs, since then the intrinsics cannot belong to these images.
slam::Camera fit_camera_to_images(const slam::Camera& camera, int width, int height,
                                  const std::string& camera_name);

}  // namespace planecast::engine
