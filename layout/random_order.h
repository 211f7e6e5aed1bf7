// What the papers measure against.
#pragma once
#include <cstdint>

#include "matrix/permutation.h"

namespace vismat {

/// Uniformly random (Fisher-Yates), the same on every platform. O(size). The worst order of any use: take any other.
Permutation random_order(std::uint32_t size, std::uint64_t seed);

}  // namespace vismat
