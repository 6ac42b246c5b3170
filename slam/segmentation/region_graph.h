#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace planecast::slam {

/// Sums over the pixels of one region of a network's maps.
struct RegionSums {
  float pixels = 0.0F;
  float planarity = 0.0F;            ///< probabilities
  std::array<float, 3> normal = {};  ///< unit normals
  std::array<float, 4> embedding = {};

  RegionSums& operator+=(const RegionSums& other);
  /// Between the regions' mean embeddings.
  static float distance(const RegionSums& a, const RegionSums& b);
  /// Of the angle between their mean normals.
  static float cosine(const RegionSums& a, const RegionSums& b);
};

/// What it costs to take two neighbouring regions for one: the mean probability of a step across
/// their border and how much they differ, weighted.
struct MergeCosts {
  float embedding = 0.45F;  ///< per unit of distance
  float normal = 0.5F;      ///< per 1 - cosine
  float planarity = 0.6F;   ///< per difference of the mean probabilities
  float most = 1.0F;        ///< that is paid
};

/// Regions and the borders between them; merges the cheapest pair until none is cheap enough.
class RegionGraph {
 public:
  explicit RegionGraph(std::vector<RegionSums> regions);
  /// One step of the border between regions a and b, and how likely it leaves an instance.
  void add_border(int a, int b, float probability);
  void merge(const MergeCosts& costs);
  /// The region that `region` has become part of.
  int root(int region) const;
  const RegionSums& sums(int root) const { return regions_[static_cast<std::size_t>(root)]; }
  int count() const { return static_cast<int>(regions_.size()); }

 private:
  struct Border {
    float probability = 0.0F;  ///< summed over the steps
    float steps = 0.0F;
  };
  Border& border(int a, int b) {
    return borders_[static_cast<std::size_t>(a) * regions_.size() + static_cast<std::size_t>(b)];
  }
  float cost(int a, int b, const MergeCosts& costs);
  void unite(int kept, int gone);

  std::vector<RegionSums> regions_;
  std::vector<Border> borders_;  ///< symmetric
  std::vector<int> parent_;
  std::vector<int> version_;  ///< changes with every merge, so that old costs are recognised
};

}  // namespace planecast::slam
