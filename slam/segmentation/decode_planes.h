#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "slam/segmentation/region_graph.h"

namespace planecast::slam {

/// What the network says of each pixel of its maps.
class PlaneMaps {
 public:
  static constexpr int kFine = 3;    ///< planarity, step to the right, step down
  static constexpr int kCoarse = 7;  ///< normal, embedding
  static constexpr int kEmbedding = 4;
  /// Of the network's output: of each fine map four values a cell of 2x2 pixels, of the others one.
  static constexpr int kChannels = 4 * kFine + kCoarse;

  PlaneMaps(int rows, int cols);
  /// From kChannels x (rows / 2) x (cols / 2) floats, in the order of the accessors below; the
  /// coarse maps are interpolated.
  static PlaneMaps of(const float* block, int rows, int cols);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  int pixels() const { return rows_ * cols_; }
  float* planarity() { return plane(0); }  ///< logit: on a plane
  float* right() { return plane(1); }      ///< logit: the pixel to the right is of something else
  float* down() { return plane(2); }       ///< logit: the pixel below is
  float* normal(int axis) { return plane(kFine + axis); }   ///< not normalised, camera's frame
  float* embedding(int c) { return plane(kFine + 3 + c); }  ///< near on one plane, apart on two
  const float* planarity() const { return plane(0); }
  const float* right() const { return plane(1); }
  const float* down() const { return plane(2); }
  const float* normal(int axis) const { return plane(kFine + axis); }
  const float* embedding(int c) const { return plane(kFine + 3 + c); }

 private:
  float* plane(int index) { return values_.data() + offset(index); }
  const float* plane(int index) const { return values_.data() + offset(index); }
  std::ptrdiff_t offset(int index) const { return static_cast<std::ptrdiff_t>(index) * pixels(); }

  int rows_;
  int cols_;
  std::vector<float> values_;
};

/// Chosen on the validation rooms (scripts/train/README.md).
struct DecodeOptions {
  float coherence = 0.19F;         ///< k of the first grouping: larger, larger groups
  float embedding_weight = 0.55F;  ///< of a step's change of embedding against its probability
  double small_share = 0.0016;     ///< of the picture; smaller groups join a neighbour
  MergeCosts costs;
  float min_planarity = 0.5F;  ///< mean probability of an instance
  float same_distance = 0.6F;  ///< embeddings of two parts of one plane...
  float same_cosine = 0.96F;   ///< ...and their normals
  double min_share = 0.0045;   ///< of the picture; smaller instances are dropped
};

/// Instances from a network's maps: CV_16U of their size, 0 = not planar, 1, 2, ... by falling
/// size. Pixels are grouped along weak steps (graph-based segmentation, Felzenszwalb & Huttenlocher
/// 2004), groups merged across weak borders, and what is planar and alike is one plane also where
/// something stands between.
cv::Mat decode_planes(const PlaneMaps& maps, const DecodeOptions& options = {});

}  // namespace planecast::slam
