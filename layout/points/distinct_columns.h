// Equal columns, collapsed into one and unfolded again.
#pragma once
#include <cstdint>
#include <vector>

#include "layout/points/sparse_points.h"
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Equal columns stand side by side in some order of fewest runs, so orders may be sought among the distinct ones alone: a third
/// to nine tenths fewer on a level's faces.
struct DistinctColumns {
  VisibilityMatrix matrix;  // the first of each kind, in order of first appearance, an empty one last
  std::vector<std::uint32_t> distinct_of_column;  // which kind each column is
};

/// SparsePoints finds them; O(ones + columns log columns).
DistinctColumns distinct_columns(const VisibilityMatrix& matrix);
/// The points as columns: column p is point p.
VisibilityMatrix matrix_of(const SparsePoints& points);
/// An order of the kinds as one of all columns; those of one kind keep their order.
Permutation unfold(const Permutation& order_of_distinct,
                   const std::vector<std::uint32_t>& distinct_of_column);

}  // namespace vismat
