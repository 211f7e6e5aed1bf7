// Random orders and samples. Published figures on orders are relative to a random order.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/base/random.h"
#include "matrix/permutation.h"

namespace vismat {

/// Uniformly random (Fisher-Yates), the same on every platform. O(size). Any other order is better.
Permutation random_order(std::uint32_t size, std::uint64_t seed);

/// `count` different numbers below `size`, in random order. O(size).
std::vector<std::uint32_t> random_sample(std::uint32_t size, std::uint32_t count, Random& random);

}  // namespace vismat
