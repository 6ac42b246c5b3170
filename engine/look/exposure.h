#pragma once

#include <opencv2/core.hpp>

#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

struct ExposureOptions {
  int min_points = 60;    ///< visible map points below which nothing is said
  int max_points = 1500;  ///< of the map, evenly taken: a median needs no more
  double max_gain = 2.0;  ///< and its inverse: beyond that something else happened
};

/// How bright a frame is beside the map: the median over visible map points of their linear
/// luminance in the picture over that of their colour in the map. Content, unlike a mean of the
/// picture, cancels out; points that are hidden are outliers to the median. 1 when too few points
/// are in view. `image` is CV_8UC3 BGR or CV_8UC1, raw pixels.
double exposure_gain(const Reconstruction& reconstruction, const cv::Mat& image,
                     const slam::Pose& world_from_cam, const ExposureOptions& options = {});

}  // namespace planecast::engine
