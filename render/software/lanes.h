#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#ifdef __SSE4_1__
#include <smmintrin.h>
#endif

namespace planecast::render {

/// Four values side by side, as processors have them. Element-wise operators; comparisons give 0 or
/// -1 in each lane.
using F4 = float __attribute__((vector_size(16)));
using I4 = std::int32_t __attribute__((vector_size(16)));
using L4 = std::int64_t __attribute__((vector_size(32)));

/// How many points are worked on at once in loops that the compiler makes vectors of.
inline constexpr std::size_t kLanes = 32;
using Lane = std::array<float, kLanes>;
using LaneInt = std::array<std::int32_t, kLanes>;

/// One bit for each lane that is -1; all lanes must be 0 or -1.
inline unsigned bits_of(const I4& mask) {
#ifdef __SSE4_1__
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
  const I4 bits = mask & I4{1, 2, 4, 8};
  return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
}

/// For the parts of loops that are to become vectors as a whole.
#define PLANECAST_INLINE inline __attribute__((always_inline))

/// Functions marked so are compiled for several instruction sets; the best is taken when the
/// program starts. The files they are in forbid fused multiply-add, so all give the same bytes.
/// Sanitizers come up later than that choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PLANECAST_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define PLANECAST_WIDE
#endif

/// For loops that are to stay one step at a time.
#if defined(__GNUC__) && !defined(__clang__)
#define PLANECAST_SCALAR \
  __attribute__((noinline, optimize("no-tree-vectorize", "no-tree-slp-vectorize")))
#else
#define PLANECAST_SCALAR __attribute__((noinline))
#endif

/// Values of kLanes places. One by one through memory: taking places out of vectors and putting
/// values into them, as compilers do where they see such a loop, takes several times longer.
template <typename T>
PLANECAST_SCALAR void pick(const T* from, const LaneInt& at, std::array<T, kLanes>& out) {
  for (std::size_t i = 0; i < kLanes; ++i) out[i] = from[at[i]];
}

/// Two neighbours of each lane, one after the other.
template <typename T>
struct alignas(64) LanePairs {
  std::array<T, 2 * kLanes> values;
};
template <typename T>
PLANECAST_SCALAR void pick_pairs(const T* from, const LaneInt& at, LanePairs<T>& out) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    std::memcpy(&out.values[2 * i], from + at[i], 2 * sizeof(T));
  }
}

PLANECAST_INLINE float larger(float a, float b) { return a > b ? a : b; }
PLANECAST_INLINE float smaller(float a, float b) { return a < b ? a : b; }

/// log2 for x > 0, the same bits everywhere; least squares on 1..2 that meets 0 and 1 at the ends,
/// off by 2e-5 at most.
PLANECAST_INLINE float fast_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const auto exponent = static_cast<float>(static_cast<std::int32_t>(bits >> 23U) - 127);
  const float t = std::bit_cast<float>((bits & 0x007FFFFFU) | 0x3F800000U) - 1.0F;
  return exponent +
         t * (1.44183587F +
              t * (-0.70837215F + t * (0.41355505F + t * (-0.19126251F + t * 0.04424374F))));
}

/// 2^x for x <= 0; least squares on 0..1, off by 5e-6 at most.
PLANECAST_INLINE float exp2_of_negative(float x) {
  const float limited = larger(x, -100.0F);
  const auto whole = static_cast<std::int32_t>(limited - 1.0F);  // leaves 0 < t <= 1
  const float t = limited - static_cast<float>(whole);
  const float p =
      1.0F + t * (0.69300488F + t * (0.24153961F + t * (0.05176606F + t * 0.01368946F)));
  return p * std::bit_cast<float>((whole + 127) << 23);
}

}  // namespace planecast::render
