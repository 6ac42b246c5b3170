#pragma once

#include <cstddef>
#include <cstdint>

namespace planecast::slam {

/// SplitMix64 (Steele, Lea, Flood 2014). The same numbers on every platform and standard library,
/// which the distributions of <random> do not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// Uniform in 0..bound-1. Precondition: bound > 0; the bias, bound / 2^32, is of no importance
  /// here.
  int below(int bound) {
    return static_cast<int>(((next() >> 32) * static_cast<std::uint64_t>(bound)) >> 32);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

  /// Fills `sample` with distinct numbers of 0..bound-1. Precondition: bound >= size of `sample`.
  template <typename Sample>
  void draw_distinct(int bound, Sample& sample) {
    for (std::size_t i = 0; i < sample.size();) {
      sample[i] = below(bound);
      bool is_new = true;
      for (std::size_t j = 0; j < i; ++j) is_new = is_new && sample[j] != sample[i];
      if (is_new) ++i;
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace planecast::slam
