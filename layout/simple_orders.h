// Orders that look at no pair of columns.
#pragma once
#include <cstdint>
#include <span>

#include "matrix/dataset.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Uniformly random (Fisher-Yates): what the papers measure against.
Permutation random_order(std::uint32_t size, std::uint64_t seed);

/// Columns sorted as bit strings, first row first, ones before zeros; ties keep their order. Equal columns end up side by
/// side, and long runs in the first rows, none in particular in the last: breaks where early rows say little.
/// O(ones + columns log columns * shared prefix).
Permutation lexicographic_order(const VisibilityMatrix& matrix);

/// Objects along a Z-order curve through the centres of their boxes [Morton 1966], 21 bits an axis over the common box.
/// Knows nothing of who sees what: breaks where near objects are hidden from one another, as in a building.
Permutation morton_order(std::span<const Box> bounds);

}  // namespace vismat
