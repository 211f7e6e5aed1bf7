// Columns as words of a dictionary.
#pragma once
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Columns sorted as bit strings, first row first, ones before zeros; ties keep their order. Equal columns end up side by
/// side, and long runs in the first rows, none in particular in the last: breaks where early rows say little, as they do
/// in every matrix of more than some tens of rows. Use order_by_polished_tour or order_by_scale_tour there.
/// O(ones + columns log columns * shared prefix).
Permutation lexicographic_order(const VisibilityMatrix& matrix);

}  // namespace vismat
