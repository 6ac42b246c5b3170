#pragma once

#include <opencv2/core.hpp>

#include "slam/segmentation/region_graph.h"

namespace planecast::slam {

/// What the network says of each of its pixels: nine planes of CV_32F, one after the other.
struct PlaneMaps {
  static constexpr int kChannels = 9;

  int rows = 0;
  int cols = 0;
  const float* planarity = nullptr;  ///< logit: on a plane
  const float* boundary = nullptr;   ///< logit: beside another instance
  const float* normal = nullptr;     ///< three, not normalised, in the camera's frame
  const float* embedding = nullptr;  ///< four: near on one plane, apart on two

  /// Views of a block of kChannels x rows x cols floats, in this order.
  static PlaneMaps of(const float* block, int rows, int cols);
};

/// Chosen on the validation rooms (scripts/train/README.md).
struct DecodeOptions {
  float coherence = 0.3F;         ///< k of the first grouping: larger, larger groups
  float embedding_weight = 1.0F;  ///< of a step's change of embedding against its boundary
  double small_share = 0.0037;    ///< of the picture; smaller groups join a neighbour
  MergeCosts costs;
  float min_planarity = 0.5F;  ///< mean probability of an instance
  float same_distance = 0.6F;  ///< embeddings of two parts of one plane...
  float same_cosine = 0.95F;   ///< ...and their normals
  double min_share = 0.002;    ///< of the picture; smaller instances are dropped
};

/// Instances from a network's maps: CV_16U of their size, 0 = not planar, 1, 2, ... by falling
/// size. Pixels are grouped along weak steps (graph-based segmentation, Felzenszwalb & Huttenlocher
/// 2004), groups merged across weak borders, and what is planar and alike is one plane also where
/// something stands between.
cv::Mat decode_planes(const PlaneMaps& maps, const DecodeOptions& options = {});

}  // namespace planecast::slam
