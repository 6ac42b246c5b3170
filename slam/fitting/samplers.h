#pragma once

#include <vector>

#include "slam/geometry/random.h"
#include "slam/geometry/two_view.h"

namespace planecast::slam {

/// Draws minimal samples of `sample_size` different points out of n, all alike [P, for planes].
class UniformSampler {
 public:
  UniformSampler(int n, int sample_size) : n_(n), sample_size_(sample_size) {}
  void draw(Random& random, int* sample) { random.distinct(sample_size_, n_, sample); }

 private:
  int n_;
  int sample_size_;
};

/// PROSAC (Chum and Matas, CVPR 2005): points are sorted best first; the pool from which samples
/// come grows from the best few to all as the growth function T' prescribes.
class ProsacSampler {
 public:
  ProsacSampler(int n, int sample_size);
  void draw(Random& random, int* sample);
  /// Number of draws T'_k after which a pool of k points is outgrown; k = sample_size .. n.
  const std::vector<int>& growth() const { return growth_; }

 private:
  int n_;
  int sample_size_;
  int pool_;
  int draws_ = 0;
  std::vector<int> growth_;  ///< indexed by pool size
};

/// Progressive NAPSAC (Barath et al., arXiv 1906.02295): samples are first local, from one grid
/// cell of both images, finest grid first; each point's neighbourhood grows with the times it was
/// the centre and ends as all points, that is as PROSAC. Matches are sorted by quality, best first,
/// and kept by reference.
class ProgressiveNapsacSampler {
 public:
  ProgressiveNapsacSampler(const std::vector<PointPair>& pairs, int width, int height,
                           int sample_size);
  void draw(Random& random, int* sample);

 private:
  /// One grid: the points by cell, in order of quality within each.
  struct Layer {
    std::vector<int> items;
    std::vector<int> begin;  ///< per point: its cell's first position in items
    std::vector<int> size;   ///< per point: its cell's number of points
  };
  Layer build_layer(int cells) const;
  /// Builds it when it is first asked for: the coarse ones often are not needed at all.
  const Layer& layer(int index);
  bool draw_local(Random& random, int centre, int* sample);
  int draw_centre(Random& random);

  int n_;
  int sample_size_;
  int draws_ = 0;
  ProsacSampler global_;
  const std::vector<PointPair>& pairs_;
  int width_;
  int height_;
  std::vector<Layer> layers_;
  std::vector<int> hits_;        ///< per point: times it was the centre
  std::vector<int> neighbours_;  ///< per point: size of its neighbourhood, without itself
  std::vector<int> layer_;       ///< per point: finest grid whose cell holds that many
};

}  // namespace planecast::slam
