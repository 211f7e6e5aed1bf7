// What an order of columns costs.
#pragma once
#include <cstdint>

#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Maximal groups of ones over all rows, with the columns as they stand. O(ones).
std::uint64_t count_runs(const VisibilityMatrix& matrix);
/// As count_runs(permute(matrix, rows as they stand, columns)), without making that. O(ones).
std::uint64_t count_runs(const VisibilityMatrix& matrix, const Permutation& columns);

}  // namespace vismat
