#pragma once

#include <cstdint>

namespace planecast::slam {

/// Small seeded generator (SplitMix64, Steele et al., OOPSLA 2014): the same numbers with every
/// standard library, unlike std::uniform_int_distribution, and free to create, so that every task
/// has its own.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// Uniform in 0 .. n-1; n > 0.
  int below(int n) {
    return static_cast<int>(((next() >> 32) * static_cast<std::uint64_t>(n)) >> 32);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Writes `count` different numbers of 0 .. n-1; count is small and at most n.
  void distinct(int count, int n, int* out) {
    for (int i = 0; i < count; ++i) {
      bool fresh = false;
      while (!fresh) {
        out[i] = below(n);
        fresh = true;
        for (int j = 0; j < i; ++j) fresh = fresh && out[j] != out[i];
      }
    }
  }

 private:
  std::uint64_t state_;
};

/// A seed for task `b` of task `a`: neighbouring numbers give unrelated streams.
inline std::uint64_t mix_seed(std::uint64_t a, std::uint64_t b) {
  return Random(a ^ (b * 0xd1342543de82ef95ULL)).next();
}

}  // namespace planecast::slam
