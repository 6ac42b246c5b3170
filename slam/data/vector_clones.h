#pragma once

/// Before a function's definition: it is compiled once more for processors with wider vectors, and
/// the loader picks one. AVX2 alone brings no fused multiplications and nothing is reordered, so
/// that both give the same bits. Not under sanitizers, which are not ready yet when the loader
/// picks.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define PLANECAST_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PLANECAST_VECTOR_CLONES
#endif
