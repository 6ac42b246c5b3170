#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "slam/data/camera.h"
#include "slam/data/types.h"

namespace planecast::engine {

/// Light at the place of the objects, in linear RGB radiance and world directions. The surroundings
/// are mean * (1 + gradient . d) in direction d; the sun is one direction whose radiance is its
/// irradiance on a facing surface over pi, so that a white facing surface shows mean + sun.
struct SceneLight {
  Eigen::Vector3d mean = Eigen::Vector3d::Constant(0.4);
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Vector3d sun_direction = -Eigen::Vector3d::UnitY();  ///< unit, towards the light
  Eigen::Vector3d sun_radiance = Eigen::Vector3d::Constant(0.3);
  double exposure = 1.0;  ///< that all of these hold already

  /// Real spherical harmonics of the surroundings, order 2, ordered (0,0), (1,-1), (1,0), (1,1),
  /// ... with Y1 = 0.4886 (y, z, x); `gain` scales it.
  std::array<Eigen::Vector3d, 9> ambient_sh(double gain = 1.0) const;
};

struct LightOptions {
  double mean_albedo =
      0.35;  ///< of the surfaces of a room; turns what is seen into what shines on it
  double bright_albedo = 0.7;  ///< of its brightest tenth: paper, walls; the second opinion
  double neutral_share =
      0.5;                  ///< how far the light's colour is drawn from the scene's towards grey
  double sun_share = 0.45;  ///< of the light on a surface that faces up
  double source_share = 0.27;    ///< more of it where windows or lamps are certainly seen
  double up_gradient = 0.25;     ///< light from above over light from below, when nothing is known
  double min_brightness = 0.15;  ///< bounds of the light on a facing white surface
  double max_brightness = 1.6;
};

/// Gathers pictures of known poses and estimates one light for the whole sequence. What is seen is
/// reflected light: over the albedo of rooms it tells the brightness (the mean of what the mean
/// surface and the brightest tenth say) and, half trusted, the colour; whether one side of the room
/// is brighter tells from which side the main light comes, from above by default. An honest guess
/// for diffuse rooms, not a measurement: one picture of a room does not hold more.
class LightEstimator {
 public:
  explicit LightEstimator(const LightOptions& options = {}) : options_(options) {}

  /// `image` is CV_8UC3 BGR or CV_8UC1, raw pixels.
  void add(const cv::Mat& image, const slam::Camera& camera, const slam::Pose& world_from_cam);
  /// `up`: unit, world. Without pictures: the defaults from above.
  SceneLight estimate(const Eigen::Vector3d& up) const;

 private:
  struct Sample {
    Eigen::Vector3d direction;  ///< world, unit
    Eigen::Vector3d radiance;   ///< linear RGB
  };
  double quantile(double share) const;  ///< of luminance
  Eigen::Vector3d robust_mean() const;
  double brightness() const;
  Eigen::Vector3d side_gradient(const Eigen::Vector3d& up) const;
  Eigen::Vector3d visible_sources(const Eigen::Vector3d& up) const;

  LightOptions options_;
  std::vector<Sample> samples_;
  Eigen::Vector3d view_sum_ = Eigen::Vector3d::Zero();   ///< optical axes
  Eigen::Vector3d right_sum_ = Eigen::Vector3d::Zero();  ///< pictures' right
};

/// sRGB byte -> linear 0..1.
double srgb_to_linear(int value);

}  // namespace planecast::engine
