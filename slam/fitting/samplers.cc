#include "slam/fitting/samplers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace planecast::slam {

namespace {

/// Draws after which PROSAC has become uniform sampling [Chum and Matas 2005, section 2.1].
constexpr double kProsacDraws = 200000.0;
/// Cells per axis of the grids, finest first [Barath et al. 2019].
constexpr std::array<int, 4> kGrids = {16, 8, 4, 2};
/// [D] Share of all points that may be a centre grows to 1 over this many draws.
constexpr int kCentreDraws = 400;

}  // namespace

ProsacSampler::ProsacSampler(int n, int sample_size)
    : n_(n),
      sample_size_(sample_size),
      pool_(sample_size),
      growth_(static_cast<std::size_t>(n) + 1) {
  double expected = kProsacDraws;  // T_m
  for (int i = 0; i < sample_size; ++i) expected *= static_cast<double>(sample_size - i) / (n - i);
  int total = 1;
  for (int k = 0; k <= n; ++k) {
    if (k > sample_size) {
      const double next = expected * k / (k - sample_size);
      total += static_cast<int>(std::ceil(next - expected));
      expected = next;
    }
    growth_[k] = total;
  }
}

void ProsacSampler::draw(Random& random, int* sample) {
  ++draws_;
  while (pool_ < n_ && draws_ > growth_[pool_]) ++pool_;
  if (pool_ == n_ && draws_ > growth_[n_]) {
    random.distinct(sample_size_, n_, sample);
    return;
  }
  random.distinct(sample_size_ - 1, pool_ - 1, sample);
  sample[sample_size_ - 1] = pool_ - 1;
}

ProgressiveNapsacSampler::ProgressiveNapsacSampler(const std::vector<PointPair>& pairs, int width,
                                                   int height, int sample_size)
    : n_(static_cast<int>(pairs.size())),
      sample_size_(sample_size),
      global_(n_, sample_size),
      pairs_(pairs),
      width_(width),
      height_(height),
      layers_(kGrids.size()),
      hits_(pairs.size(), 0),
      neighbours_(pairs.size(), sample_size - 1),
      layer_(pairs.size(), 0) {}

const ProgressiveNapsacSampler::Layer& ProgressiveNapsacSampler::layer(int index) {
  Layer& layer = layers_[index];
  if (layer.items.empty()) layer = build_layer(kGrids[index]);
  return layer;
}

ProgressiveNapsacSampler::Layer ProgressiveNapsacSampler::build_layer(int cells) const {
  const auto coordinate = [cells](double value, int size) {
    return std::clamp(static_cast<int>(std::floor(value * cells / size)), 0, cells - 1);
  };
  // (cell, point) in one number, so that sorting is by cell and then by quality.
  std::vector<std::uint64_t> keys(pairs_.size());
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto& [ref, cur] = pairs_[i];
    const int cell = ((coordinate(ref.x(), width_) * cells + coordinate(ref.y(), height_)) * cells +
                      coordinate(cur.x(), width_)) *
                         cells +
                     coordinate(cur.y(), height_);
    keys[i] = static_cast<std::uint64_t>(cell) << 32 | i;
  }
  std::sort(keys.begin(), keys.end());
  Layer layer;
  layer.items.resize(keys.size());
  layer.begin.resize(keys.size());
  layer.size.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) layer.items[i] = static_cast<int>(keys[i]);
  for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
    while (last < keys.size() && keys[last] >> 32 == keys[first] >> 32) ++last;
    for (std::size_t i = first; i < last; ++i) {
      layer.begin[layer.items[i]] = static_cast<int>(first);
      layer.size[layer.items[i]] = static_cast<int>(last - first);
    }
  }
  return layer;
}

int ProgressiveNapsacSampler::draw_centre(Random& random) {
  const int pool = n_ * std::min(draws_, kCentreDraws) / kCentreDraws;
  return random.below(std::clamp(pool, std::min(n_, 5 * sample_size_), n_));
}

bool ProgressiveNapsacSampler::draw_local(Random& random, int centre, int* sample) {
  int& neighbours = neighbours_[centre];
  const int hits = ++hits_[centre];
  while (neighbours < n_ - 1 && hits > global_.growth()[neighbours + 1]) ++neighbours;
  int& layer_index = layer_[centre];
  while (layer_index < static_cast<int>(layers_.size()) &&
         layer(layer_index).size[centre] - 1 < neighbours) {
    ++layer_index;
  }
  if (layer_index == static_cast<int>(layers_.size())) return false;
  const Layer& grid = layer(layer_index);
  const int* cell = &grid.items[grid.begin[centre]];
  // Positions in the cell, with the centre left out: the newest neighbour and some better ones.
  const int rest = sample_size_ - 2;
  random.distinct(rest, neighbours - 1, sample);
  sample[rest] = neighbours - 1;
  for (int i = 0; i <= rest; ++i) {
    const int position = sample[i];
    sample[i] = cell[position] < centre ? cell[position] : cell[position + 1];
  }
  sample[sample_size_ - 1] = centre;
  return true;
}

void ProgressiveNapsacSampler::draw(Random& random, int* sample) {
  ++draws_;
  if (!draw_local(random, draw_centre(random), sample)) global_.draw(random, sample);
}

}  // namespace planecast::slam
