#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace planecast::engine {

struct SynthOptions {
  std::string name;        ///< one of synthetic_scene_names()
  std::uint64_t seed = 1;  ///< textures, things and the hand's motion
  int width = 640;
  int height = 480;
  int frames = -1;  ///< -1: the scene's own length; fewer: only its beginning
  double fps = 30.0;
  std::string lens = "none";  ///< none | wide (with barrel distortion)
  bool effects = true;  ///< camera noise, vignetting, blur, exposure drift; a noisy depth sensor
  std::string trouble = "none";  ///< see synthetic_trouble_names()
  double depth_factor = 5000;    ///< depth image units per metre
  std::string shader_dir;        ///< empty: the shaders among the assets
};

std::vector<std::string> synthetic_scene_names();
std::vector<std::string> synthetic_lens_names();
/// What makes a recording hard: blur, exposure, rolling-shutter, moving, dropped; none.
std::vector<std::string> synthetic_trouble_names();

/// Writes a sequence with exact truth in TUM format: rgb/, depth/, mask/ and their lists,
/// groundtruth.txt (world from camera; metres, z up, the floor at z = 0), camera.yaml and
/// planes.json (design section 4; `label` is the mask's value, `inliers` the number of pixels that
/// show the plane over all frames; planes that are never seen are left out). The same bytes for the
/// same options. Depth beyond 8 m is invalid. Throws UserError for an unknown name, impossible
/// sizes or a folder that cannot be written.
void write_synthetic(const SynthOptions& options, const std::filesystem::path& out,
                     const std::function<void(int done, int total)>& progress);

}  // namespace planecast::engine
