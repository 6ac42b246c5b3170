#pragma once

#include <opencv2/core.hpp>

#include "engine/look/object_layer.h"

namespace planecast::engine {

/// Blur of a picture as the standard deviations of a Gaussian along x and y. Motion blur shows in
/// one of them or both, defocus in both.
struct CameraBlur {
  double sigma_x_px = 0.0;
  double sigma_y_px = 0.0;
};

struct BlurOptions {
  double min_contrast = 24.0;  ///< grey levels that an edge must rise in two pixels
  double sharp_share =
      0.25;  ///< quantile of the edges' widths: the sharpest ones tell the camera's
  double max_sigma_px = 3.0;
  int min_edges = 60;  ///< fewer say nothing: no blur
};

/// From how much strong edges flatten when the picture is blurred once more (Zhuo and Sim, Defocus
/// map estimation from a single image, 2011, Eq. 3), edges along x and y apart. Zero is the
/// sharpness of a rendered, antialiased edge. `grey` is CV_8UC1.
CameraBlur estimate_blur(const cv::Mat& grey, const BlurOptions& options = {});

/// Blurs the layer's colours by the same amount and grows its bounds; below `kVisibleBlur`
/// untouched.
void apply_blur(const CameraBlur& blur, ObjectLayer& layer);

inline constexpr double kVisibleBlur = 0.35;  ///< sigma in pixels

}  // namespace planecast::engine
