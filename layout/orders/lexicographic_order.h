// An order of columns as bit strings, like words in a dictionary.
#pragma once
#include "matrix/permutation.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Columns sorted as bit strings, first row first, ones before zeros; ties keep their order. Equal columns become
/// neighbours. The first rows get long runs, the last rows none in particular. So it fails if the first rows say little
/// about the others, as in every matrix of more than some tens of rows; use order_by_polished_tour or
/// order_by_scale_tour there. O(ones + columns log columns * shared prefix).
Permutation lexicographic_order(const VisibilityMatrix& matrix);

}  // namespace vismat
