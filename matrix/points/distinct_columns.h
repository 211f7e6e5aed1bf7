// Equal columns collapsed into one, and expanded again.
#pragma once
#include <cstdint>
#include <vector>

#include "matrix/permutation.h"
#include "matrix/points/sparse_points.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Some order with the fewest runs has equal columns as neighbours, so it is enough to order the distinct ones.
struct DistinctColumns {
  /// The first of each set of equal columns, in order of appearance, with an empty one last.
  VisibilityMatrix matrix;
  /// Which column of `matrix` each column equals.
  std::vector<std::uint32_t> distinct_of_column;
};

/// Uses SparsePoints; O(ones + columns log columns).
DistinctColumns distinct_columns(const VisibilityMatrix& matrix);
/// The points as columns: column p is point p.
VisibilityMatrix matrix_of(const SparsePoints& points);
/// Expands an order of the distinct columns into one of all columns; equal columns keep their order.
Permutation unfold(const Permutation& order_of_distinct,
                   const std::vector<std::uint32_t>& distinct_of_column);

}  // namespace vismat
