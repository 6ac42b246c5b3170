#include "slam/segmentation/region_graph.h"

#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

namespace planecast::slam {

RegionSums& RegionSums::operator+=(const RegionSums& other) {
  pixels += other.pixels;
  planarity += other.planarity;
  for (std::size_t c = 0; c < normal.size(); ++c) normal[c] += other.normal[c];
  for (std::size_t c = 0; c < embedding.size(); ++c) embedding[c] += other.embedding[c];
  return *this;
}

float RegionSums::distance(const RegionSums& a, const RegionSums& b) {
  float sum = 0.0F;
  for (std::size_t c = 0; c < a.embedding.size(); ++c) {
    const float d = a.embedding[c] / a.pixels - b.embedding[c] / b.pixels;
    sum += d * d;
  }
  return std::sqrt(sum);
}

float RegionSums::cosine(const RegionSums& a, const RegionSums& b) {
  float ab = 0.0F;
  float aa = 1e-9F;
  float bb = 1e-9F;
  for (std::size_t c = 0; c < a.normal.size(); ++c) {
    ab += a.normal[c] * b.normal[c];
    aa += a.normal[c] * a.normal[c];
    bb += b.normal[c] * b.normal[c];
  }
  return ab / std::sqrt(aa * bb);
}

RegionGraph::RegionGraph(std::vector<RegionSums> regions)
    : regions_(std::move(regions)),
      borders_(regions_.size() * regions_.size()),
      parent_(regions_.size()),
      version_(regions_.size(), 0) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

void RegionGraph::add_border(int a, int b, float probability) {
  for (Border* one : {&border(a, b), &border(b, a)}) {
    one->probability += probability;
    one->steps += 1.0F;
  }
}

int RegionGraph::root(int region) const {
  while (parent_[static_cast<std::size_t>(region)] != region) {
    region = parent_[static_cast<std::size_t>(region)];
  }
  return region;
}

float RegionGraph::cost(int a, int b, const MergeCosts& costs) {
  const RegionSums& p = sums(a);
  const RegionSums& q = sums(b);
  return border(a, b).probability / border(a, b).steps +
         costs.embedding * RegionSums::distance(p, q) +
         costs.normal * (1.0F - RegionSums::cosine(p, q)) +
         costs.planarity * std::abs(p.planarity / p.pixels - q.planarity / q.pixels);
}

void RegionGraph::unite(int kept, int gone) {
  regions_[static_cast<std::size_t>(kept)] += sums(gone);
  parent_[static_cast<std::size_t>(gone)] = kept;
  ++version_[static_cast<std::size_t>(kept)];
  ++version_[static_cast<std::size_t>(gone)];
  border(kept, gone) = border(gone, kept) = {};
  for (int other = 0; other < count(); ++other) {
    Border& moved = border(gone, other);
    if (moved.steps == 0.0F) continue;
    for (Border* one : {&border(kept, other), &border(other, kept)}) {
      one->probability += moved.probability;
      one->steps += moved.steps;
    }
    border(other, gone) = {};
    moved = {};
  }
}

void RegionGraph::merge(const MergeCosts& costs) {
  // (cost, a, b, versions): ties go by number, so that the result is one.
  using Entry = std::tuple<float, int, int, int, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto version = [this](int region) { return version_[static_cast<std::size_t>(region)]; };
  const auto offer = [&](int a, int b) {
    if (border(a, b).steps == 0.0F) return;
    const float price = cost(a, b, costs);
    if (price <= costs.most) queue.emplace(price, a, b, version(a), version(b));
  };
  for (int a = 0; a < count(); ++a) {
    for (int b = a + 1; b < count(); ++b) offer(a, b);
  }
  while (!queue.empty()) {
    const auto [price, a, b, version_a, version_b] = queue.top();
    queue.pop();
    if (version(a) != version_a || version(b) != version_b) continue;
    unite(a, b);
    for (int other = 0; other < count(); ++other) offer(a, other);
  }
}

}  // namespace planecast::slam
