// The cost of an order of columns: its number of runs.
#pragma once
#include <cstdint>

#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// The number of runs in all rows, with the columns as they are. O(ones).
std::uint64_t count_runs(const VisibilityMatrix& matrix);
/// Equals count_runs(permute(matrix, rows as they are, columns)), without computing that matrix. O(ones).
std::uint64_t count_runs(const VisibilityMatrix& matrix, const Permutation& columns);
/// The mean of count_runs over all orders of the columns, exactly: a row of k ones among n columns has k (n - k + 1) / n on average.
double mean_runs_of_random(const VisibilityMatrix& matrix);

}  // namespace vismat
