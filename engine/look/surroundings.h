#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "engine/look/light.h"
#include "render/image.h"
#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::engine {

struct SurroundingsOptions {
  int height = 64;            ///< of the panorama, twice as wide
  double blend_texels = 6.0;  ///< over which what was seen fades into what is guessed
};

/// What the camera saw of a room, laid out by direction alone: what polished things reflect. Where
/// things are near, their parallax is ignored.
class Surroundings {
 public:
  explicit Surroundings(const SurroundingsOptions& options = {});

  /// `image` is CV_8UC3 BGR or CV_8UC1, raw pixels, exposed `gain` times as much as is wanted.
  void add(const cv::Mat& image, const slam::Camera& camera, const slam::Pose& world_from_cam,
           double gain = 1.0);
  /// Share of the sphere that was seen.
  double seen() const;
  /// Equirectangular linear radiance in the world's axes, see render::Environment; where nothing
  /// was seen the light's own surroundings: what lights the room is mostly out of view.
  render::ImageF panorama(const SceneLight& light) const;

 private:
  SurroundingsOptions options_;
  cv::Mat sum_;     ///< CV_32FC3, RGB
  cv::Mat weight_;  ///< CV_32FC1
};

}  // namespace planecast::engine
