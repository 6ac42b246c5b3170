#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "engine/sequence/synth/training_raster.h"
#include "engine/sequence/synth/training_room.h"

namespace planecast::engine::synth {

inline constexpr int kTrainingWidth = 192;
inline constexpr int kTrainingHeight = 144;
inline constexpr int kIgnoredLabel = 255;  ///< flat, but too small to be asked for

/// One picture with its truth, 192x144. Portrait and wide pictures are squeezed to that size, as
/// the network sees them.
struct TrainingSample {
  cv::Mat bgr;              ///< CV_8UC3
  cv::Mat labels;           ///< CV_8U: 1.. plane instances, 0 not planar, kIgnoredLabel
  cv::Mat normals;          ///< CV_8SC3: 127 x the unit normal in the camera's frame
  double non_planar = 0.0;  ///< share of the pixels whose label is 0 or ignored
};

struct TrainingViewOptions {
  double min_plane_share = 0.005;  ///< of the picture; smaller ones are ignored: too few landmarks
};

/// Seed of the `view`-th picture of a room; up to 64 of them differ from those of other rooms.
inline std::uint64_t view_seed(std::uint64_t room_seed, std::uint64_t view) {
  return room_seed * 64U + view;
}

/// The labels that must be found, as CV_16U: what is ignored in training counts as not planar.
cv::Mat asked_labels(const cv::Mat& labels);

/// Draws views of one room. Light and shadows are worked out once.
class TrainingPainter {
 public:
  TrainingPainter(const TrainingRoom& room, TileBank& bank, std::uint64_t seed);
  TrainingSample draw(std::uint64_t view_seed, const TrainingViewOptions& options = {});

 private:
  struct Light {
    Eigen::Vector3f position;
    Color power;  ///< irradiance at 1 m
    bool casts = true;
    int softness = 2;  ///< texels
    RasterCamera camera;
    RasterImage shadow;
  };
  struct View {
    RasterCamera camera;  ///< at twice the size
    RasterImage image;
  };
  void add_light(Random& random, const Eigen::Vector3f& position, const Eigen::Vector3f& forward,
                 const Color& power, float half_field);
  View choose_view(Random& random) const;
  RasterCamera random_camera(Random& random) const;
  /// How much the eye would rather not look at: too near, or nothing but one wall.
  double dislike(const RasterImage& image, Random& random) const;
  float lit(const Light& light, const Eigen::Vector3f& point, std::uint32_t hash) const;
  Color shade(const View& view, int x, int y) const;
  Color surface(const RasterTriangle& triangle, const Eigen::Vector2f& uv, float footprint_m,
                Color& glow) const;
  void write_truth(const View& view, const TrainingViewOptions& options,
                   TrainingSample& sample) const;

  const TrainingRoom& room_;
  TileBank& bank_;
  std::vector<RasterTriangle> triangles_;
  std::vector<Light> lights_;
  Color ambient_ = Color::Ones();
};

}  // namespace planecast::engine::synth
