#include "engine/pipeline/earlier_map.h"

#include <cmath>
#include <filesystem>

#include "engine/pipeline/map_bin.h"
#include "engine/user_error.h"

namespace planecast::engine {
namespace {

bool same_camera(const slam::Camera& a, const slam::Camera& b) {
  constexpr double kFocalShare = 1e-3;
  constexpr double kCentrePx = 0.5;
  return a.lens == b.lens && std::abs(a.fx - b.fx) < kFocalShare * std::abs(a.fx) &&
         std::abs(a.fy - b.fy) < kFocalShare * std::abs(a.fy) &&
         std::abs(a.cx - b.cx) < kCentrePx && std::abs(a.cy - b.cy) < kCentrePx &&
         a.distortion == b.distortion;
}

}  // namespace

EarlierMap read_earlier_map(const std::string& folder, const Sequence& sequence, bool rgbd) {
  EarlierMap earlier{sequence.camera(), rgbd, nullptr};
  if (folder.empty()) return earlier;
  const std::filesystem::path path = std::filesystem::path(folder) / "map.bin";
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    throw UserError(folder + ": is not a reconstruction folder (it has no map.bin)");
  }
  Reconstruction reconstruction;
  read_map_bin(path, reconstruction, true);
  if (reconstruction.map == nullptr || reconstruction.map->keyframes.empty()) {
    throw UserError(path.string() + ": has no map to go on from");
  }
  const slam::Camera& camera = reconstruction.camera;
  const slam::Camera& wanted = sequence.camera();
  if (camera.width != wanted.width || camera.height != wanted.height ||
      (!(camera.guessed && wanted.guessed) && !same_camera(camera, wanted))) {
    throw UserError(path.string() + ": was made with another camera than this sequence's");
  }
  if (rgbd && !reconstruction.metric) {
    throw UserError(path.string() + ": has no metric scale; use --mode mono");
  }
  return {camera, reconstruction.metric, reconstruction.map};
}

}  // namespace planecast::engine
