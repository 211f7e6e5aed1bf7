// The instructions that decoders of rows may use beyond those that every processor of its kind has. Who uses them takes
// the best ones when a payload is opened, and tests take each in turn: what is decoded is the same.
#pragma once

namespace vismat {

/// none: portable code. avx2: also BMI2 and POPCNT, where bits are extracted and deposited fast (not AMD before Zen 3, which does
/// it bit by bit). avx512: also VBMI2 (Ice Lake, Zen 4 and later).
enum class Simd { none, avx2, avx512 };

/// The best that this processor has.
inline Simd best_simd() {
#if defined(__x86_64__)
  static const Simd best = [] {
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi") ||
        !__builtin_cpu_supports("bmi2") || !__builtin_cpu_supports("popcnt") ||
        __builtin_cpu_is("amdfam15h") || __builtin_cpu_is("amdfam17h"))
      return Simd::none;
    const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512vbmi2");
    return wide ? Simd::avx512 : Simd::avx2;
  }();
  return best;
#else
  return Simd::none;
#endif
}

}  // namespace vismat
