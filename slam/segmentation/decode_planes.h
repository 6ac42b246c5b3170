#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace planecast::slam {

/// What the network says of each of its pixels; all of one size.
struct PlaneMaps {
  cv::Mat planarity;  ///< CV_32F logit: on a plane
  cv::Mat boundary;   ///< CV_32F logit: beside another instance
  std::array<cv::Mat, 4> embedding;  ///< CV_32F each: near on one plane, apart on two
};

struct DecodeOptions {
  float min_planarity = 0.5F;  ///< probability
  float min_boundary = 0.5F;   ///< probability from which a pixel may part two instances
  float radius = 1.0F;         ///< of the mean shift, in embedding units
  int seeds = 24;              ///< at most, and so instances
  int shifts = 4;              ///< of each seed's mean
  double min_share = 0.002;    ///< of the picture; smaller instances are dropped
};

/// Instances from a network's maps: CV_16U of their size, 0 = not planar, 1, 2, ... by falling
/// size. Mean shift with a flat kernel (Yu et al. 2019, associative embedding), one seed after the
/// other, each from the middle of what is left, far from boundaries.
cv::Mat decode_planes(const PlaneMaps& maps, const DecodeOptions& options = {});

}  // namespace planecast::slam
