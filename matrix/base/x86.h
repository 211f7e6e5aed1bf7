// The instructions of x86 processors, for sources that choose them by Simd (simd.h). Empty on others.
#pragma once
#if defined(__x86_64__)
#if !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // GCC 12 warns of its own undefined vectors
#endif
#include <immintrin.h>
#if !defined(__clang__)
#pragma GCC diagnostic pop
#endif

/// The attribute of functions for Simd::avx512.
#define VISMAT_AVX512 gnu::target("avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi2,avx2,bmi,bmi2,popcnt")
#endif
