// The instruction sets that tests take in turn: those that this processor has.
#pragma once
#include <vector>

#include "matrix/base/simd.h"

namespace vismat::test {

inline std::vector<Simd> simd_here() {
  std::vector<Simd> all = {Simd::none};
  if (best_simd() >= Simd::avx2) all.push_back(Simd::avx2);
  if (best_simd() >= Simd::avx512) all.push_back(Simd::avx512);
  return all;
}

}  // namespace vismat::test
